/* What is played, each in a process of its own. */
#ifndef SCENARIOS_H
#define SCENARIOS_H

/* motions.cpp */
void refuse();
void move();
void run();
void set();
void delay_loop();
void gauge();
void for_75_minutes();
void early_poll_without_inputs();
void beside_a_line();
void a_line_that_is_not_begun();

/* axes.cpp */
void axes();
void another_begins();
void slow_ramps();
void refused_begin();
void begin_in_flight();
void begin_together();
void axis_in_flight();
void clock_of_the_good();
void shared_pins();
void enable_and_missing_pins();
void too_many_axes();

/* inputs.cpp */
void emergency_stop();
void short_stop();
void home();
void two_homes();
void soft_limits();
void bad_inputs();
void shared_inputs();
void shared_stop();
void early_poll();
void home_without_hold();
void home_beside_another();
void soft_limits_the_wrong_way_round();
void known_positions();
void known_positions_of_long_intervals();

#endif
