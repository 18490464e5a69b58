/*   scenarios NAME IMAGE     plays a scenario with a ramp image in hexadecimal; says what isn't as it should be */
#include "scenarios.h"

#include "board.h"

int main(int count, char **words)
{
    static const struct {
        const char *name;
        void (*play)();
    } SCENARIOS[] = {{"refuse", refuse}, {"move", move},           {"run", run},
                     {"set", set},       {"delay_loop", delay_loop}, {"gauge", gauge},
                     {"axes", axes},     {"refused_begin", refused_begin}, {"begin_in_flight", begin_in_flight}, {"begin_together", begin_together},
                     {"enable_and_missing_pins", enable_and_missing_pins}, {"axis_in_flight", axis_in_flight}, {"another_begins", another_begins}, {"slow_ramps", slow_ramps},
                     {"too_many_axes", too_many_axes},
                     {"shared_pins", shared_pins}, {"shared_inputs", shared_inputs}, {"shared_stop", shared_stop},
                     {"for_75_minutes", for_75_minutes},
                     {"emergency_stop", emergency_stop}, {"home", home}, {"two_homes", two_homes}, {"soft_limits", soft_limits}, {"short_stop", short_stop}, {"bad_inputs", bad_inputs},
                     {"early_poll", early_poll},
                     {"early_poll_without_inputs", early_poll_without_inputs},
                     {"beside_a_line", beside_a_line},
                     {"home_without_hold", home_without_hold},
                     {"home_beside_another", home_beside_another},
                     {"soft_limits_the_wrong_way_round", soft_limits_the_wrong_way_round},
                     {"a_line_that_is_not_begun", a_line_that_is_not_begun},
                     {"known_positions", known_positions},
                     {"known_positions_of_long_intervals", known_positions_of_long_intervals},
                     {"clock_of_the_good", clock_of_the_good}};
    CHECK(count == 3);
    unsigned byte;
    for (const char *text = words[2]; sscanf(text, "%2x", &byte) == 1; text += 2) {
        image[image_bytes++] = (uint8_t)byte;
    }
    for (const auto &scenario : SCENARIOS) {
        if (strcmp(words[1], scenario.name) == 0) {
            scenario.play();
            return 0;
        }
    }
    CHECK(!"no such scenario");
}
