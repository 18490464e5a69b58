/* Runs the firmware of an ATmega328P, or a sketch on an Arduino board, at 16 MHz in libsimavr, behind a pseudo-terminal. See --help. */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <simavr/avr_extint.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#include "host.h"

static const char help[] =
    "usage: avr_host [options] firmware.elf\n"
    "Runs the firmware of an ATmega328P, or another chip's, at 16 MHz behind a pseudo-terminal. Prints `ready` after 50 ms of\n"
    "simulated time, and on SIGTERM, SIGINT or when the power has been cut what it counted, as a line of\n"
    "JSON. SIGUSR1 is the reset button; SIGUSR2 overwrites what is behind the last variable, as a stack does that\n"
    "has come so far.\n"
    "\n"
    "  --chip NAME       atmega328p (the default), atmega2560 or atmega32u4\n"
    "  --timer N         which timer's interrupts are counted as compare_a and compare_b (default: 1): A and B of an\n"
    "                    atmega328p, else B and C\n"
    "  --link PATH       make PATH a symbolic link to the pseudo-terminal (default: avr-tty)\n"
    "  --edges FILE      log each edge of the pins of an Uno, Mega or Leonardo (A0 to A5 of an Uno\n"
    "                    are 14 to 19): i64 cycle, i8 pin, i8 value\n"
    "  --eeprom FILE     keep the EEPROM in FILE\n"
    "  --cut-power-at N  cut the power in the middle of EEPROM write N, counted from 1\n"
    "  --boot-loader FILE  begin in this boot loader, after each reset, too: it ends where the memory does\n"
    "  --boot-ms N       opening the terminal resets the processor, which then is deaf for N ms (0: no reset)\n"
    "  --press PIN:A-B   press a button between a pin and ground from A to B ms; more after commas\n"
    "  --switch PIN:X<P  a limit switch connects a pin to ground where axis X is at P or below, or with > above; more\n"
    "                    after commas\n"
    "  --free-running    run as fast as possible (default: in real time)\n"
    "  --batch           no terminal: run as fast as possible until the program sleeps for good, say what was counted\n"
    "  --data FILE       with --batch: put the bytes of FILE into the program memory, from 0x4000 on\n"
    "  --sent FILE       with --batch: what the program sends over its serial port\n"
    "  --busy            with --batch: bytes come in over the serial port without a pause\n"
    "  --requests FILE   no terminal: run as fast as possible until these requests have been answered; see host.h\n"
    "  --log FILE        with --requests: each frame and its time; see host.h\n"
    "  --help            print this\n";

enum { POLL_CYCLES = 1600 /* 100 us */, FLUSH_CYCLES = 160000 /* 10 ms */, LOOK_CYCLES = 64, PAINT = 0xA5, SRAM_BEGINS = 0x100 };
enum { READY_CYCLES = 800000 /* 50 ms */ };
enum { POWER_CUT_EXIT = 3 };
enum { DATA_BEGINS = 0x4000, MCUSR = 0x54, POWER_ON = 1, EXTERNAL_RESET = 2 };
#define LONGEST_BATCH_CYCLES (600 * CLOCK_HZ)

struct options {
    const char *chip, *timer, *link, *edges, *eeprom, *firmware, *press, *switches, *boot_loader;
    long cut_power_at;
    unsigned boot_ms;
    bool free_running, batch, busy;
    const char *data, *sent;
    const char *requests, *log;
};

static avr_t *avr;
static elf_firmware_t firmware;
static avr_cycle_count_t runs_from;
static long resets;
static FILE *sent_file;
static volatile sig_atomic_t stop_asked, reset_asked, overwrite_asked;

static void on_signal(int signal_number)
{
    if (signal_number == SIGUSR1) {
        reset_asked = 1;
    } else if (signal_number == SIGUSR2) {
        overwrite_asked = 1;
    } else {
        stop_asked = 1;
    }
}

/* Behind the firmware's last variable. */
static unsigned stack_begins(void)
{
    for (uint32_t i = 0; i < firmware.symbolcount; i++) {
        if (strcmp(firmware.symbol[i]->symbol, "_end") == 0) {
            return firmware.symbol[i]->addr & 0xFFFF;
        }
    }
    return SRAM_BEGINS + firmware.datasize + firmware.bsssize;
}

/* The stack grows down over the paint; what is left of it has never been used. */
static unsigned untouched_stack(void)
{
    unsigned address = stack_begins();
    while (address <= avr->ramend && avr->data[address] == PAINT) {
        address++;
    }
    return address - stack_begins();
}

static void print_interrupt(const char *name, struct interrupt_times times)
{
    printf("\"%s\": {\"count\": %llu, \"cycles\": %llu, \"shortest\": %llu, \"longest\": %llu}, ", name,
           (unsigned long long)times.count, (unsigned long long)times.cycles, (unsigned long long)times.shortest,
           (unsigned long long)times.longest);
}

static void finish(bool power_was_cut)
{
    struct serial_counts serial = serial_line_counts();
    edges_flush();
    serial_line_detach();
    conversation_end();
    if (sent_file) {
        fclose(sent_file);
    }
    printf("{");
    print_interrupt("compare_a", interrupt_times(chip_step_vector()));
    print_interrupt("compare_b", interrupt_times(chip_step_vector() + 1));
    print_interrupt("receive", interrupt_times(chip->receive_vector));
    printf("\"resets\": %ld, \"cycles\": %llu, \"received_bytes\": %ld, \"lost_bytes\": %ld, \"sent_bytes\": %ld, "
           "\"longest_answer_cycles\": %llu, \"eeprom_writes\": %ld, "
           "\"edges\": %ld, \"longest_interrupt_cycles\": %llu, \"stack_bytes\": %u, \"untouched_stack_bytes\": %u, "
           "\"power_was_cut\": %s}\n",
           resets, (unsigned long long)avr->cycle, serial.received, serial.lost, serial.sent,
           (unsigned long long)serial.longest_answer, eeprom_writes(), edges_count(),
           (unsigned long long)longest_step_interrupt(), avr->ramend + 1 - stack_begins(), untouched_stack(),
           power_was_cut ? "true" : "false");
    fflush(stdout);
}

static void on_power_cut(void)
{
    finish(true);
    _exit(POWER_CUT_EXIT);
}

static bool parse_options(int count, char **words, struct options *options)
{
    static const struct option names[] = {
        {"chip", required_argument, NULL, 'C'},    {"timer", required_argument, NULL, 'T'},
        {"link", required_argument, NULL, 'l'},    {"edges", required_argument, NULL, 'e'},
        {"eeprom", required_argument, NULL, 'm'},  {"cut-power-at", required_argument, NULL, 'c'},
        {"boot-ms", required_argument, NULL, 'b'}, {"free-running", no_argument, NULL, 'f'},
        {"batch", no_argument, NULL, 'B'},         {"data", required_argument, NULL, 'd'},
        {"sent", required_argument, NULL, 's'},    {"busy", no_argument, NULL, 'y'},
        {"requests", required_argument, NULL, 'r'}, {"log", required_argument, NULL, 'g'},
        {"boot-loader", required_argument, NULL, 'o'},
        {"press", required_argument, NULL, 'p'},   {"switch", required_argument, NULL, 'w'},   {"help", no_argument, NULL, 'h'},
        {NULL, 0, NULL, 0}};
    int option;
    while ((option = getopt_long(count, words, "", names, NULL)) != -1) {
        switch (option) {
        case 'C': options->chip = optarg; break;
        case 'T': options->timer = optarg; break;
        case 'l': options->link = optarg; break;
        case 'e': options->edges = optarg; break;
        case 'm': options->eeprom = optarg; break;
        case 'c': options->cut_power_at = strtol(optarg, NULL, 10); break;
        case 'b': options->boot_ms = (unsigned)strtoul(optarg, NULL, 10); break;
        case 'f': options->free_running = true; break;
        case 'B': options->batch = true; break;
        case 'd': options->data = optarg; break;
        case 's': options->sent = optarg; break;
        case 'y': options->busy = true; break;
        case 'r': options->requests = optarg; break;
        case 'g': options->log = optarg; break;
        case 'p': options->press = optarg; break;
        case 'w': options->switches = optarg; break;
        case 'o': options->boot_loader = optarg; break;
        case 'h': fputs(help, stdout); exit(0);
        default: return false;
        }
    }
    options->firmware = words[optind];
    return optind == count - 1;
}

/* Standard output is ours: simavr may only complain, and to standard error. */
static void log_errors(avr_t *mcu, const int level, const char *format, va_list values)
{
    (void)mcu;
    if (level == LOG_ERROR) {
        vfprintf(stderr, format, values);
    }
}

static bool load_data(const char *file)
{
    FILE *data = fopen(file, "rb");
    if (!data) {
        perror(file);
        return false;
    }
    size_t count = fread(avr->flash + DATA_BEGINS, 1, avr->flashend - DATA_BEGINS, data);
    bool is_all = fgetc(data) == EOF && count > 0;
    fclose(data);
    return is_all;
}

/* Puts a boot loader at the end of the program memory, and has the processor begin there, as its fuse does. */
static bool load_boot_loader(const char *file)
{
    FILE *loader = fopen(file, "rb");
    if (!loader) {
        perror(file);
        return false;
    }
    fseek(loader, 0, SEEK_END);
    long size = ftell(loader);
    rewind(loader);
    avr_flashaddr_t begin = avr->flashend + 1 - (avr_flashaddr_t)size;
    bool is_all = size > 0 && size < (long)avr->flashend && fread(avr->flash + begin, 1, (size_t)size, loader) == (size_t)size;
    fclose(loader);
    avr->codeend = avr->flashend;
    avr->reset_pc = avr->pc = begin;
    return is_all;
}

static bool attach_line(const struct options *options)
{
    if (options->requests) {
        return conversation_attach(avr, options->requests, options->log);
    }
    if (!options->batch) {
        return serial_line_attach(avr, options->link, options->boot_ms);
    }
    if (options->sent && !(sent_file = fopen(options->sent, "wb"))) {
        perror(options->sent);
        return false;
    }
    serial_line_attach_to_file(avr, sent_file, options->busy);
    return !options->data || load_data(options->data);
}

/* While a pin of INT0, INT1 … is low, and its interrupt one of a level, simavr looks at it in each cycle, enabled or not: most
 * of its time went there. Nothing here has interrupts of a level. A reset turns it on again. */
static void stop_looking_at_levels(void)
{
    for (uint8_t i = 0; i < EXTINT_COUNT; i++) {
        avr_extint_set_strict_lvl_trig(avr, i, 0);
    }
}

/* Called by simavr at each reset, whatever its reason. */
static void on_reset(avr_io_t *unused)
{
    (void)unused;
    resets++;
    step_timers_reset();
    other_timers_reset();
    interrupts_reset();
    edges_reset();
    serial_line_reset();
}

static bool load(const struct options *options)
{
    static avr_io_t resetting = {.kind = "reset", .reset = on_reset};
    avr_global_logger_set(log_errors);
    if (elf_read_firmware(options->firmware, &firmware) != 0) {
        return false;
    }
    firmware.frequency = CLOCK_HZ;
    avr = avr_make_mcu_by_name(chip->name);
    avr_init(avr);
    stop_looking_at_levels();
    avr_load_firmware(avr, &firmware);
    memset(avr->data + stack_begins(), PAINT, avr->ramend + 1 - stack_begins());
    avr->data[MCUSR] = POWER_ON;
    if (options->boot_loader && !load_boot_loader(options->boot_loader)) {
        return false;
    }
    step_timers_attach(avr);
    other_timers_attach(avr);
    interrupts_attach(avr);
    avr_register_io(avr, &resetting);
    return eeprom_attach(avr, options->eeprom, options->cut_power_at, on_power_cut) &&
           edges_attach(avr, options->edges) && button_attach(avr, options->press) &&
           switch_attach(avr, options->switches) &&
           attach_line(options);
}

/* Resets the processor. It begins to run after `boot_ms`, as its boot loader waits so long for a new program. */
static void reset(unsigned boot_ms)
{
    avr_cycle_count_t now = avr->cycle;
    avr_reset(avr);
    stop_looking_at_levels();
    avr->data[MCUSR] = EXTERNAL_RESET;
    avr->cycle = now;
    runs_from = now + CLOCK_HZ / 1000 * boot_ms;
    serial_line_deaf_until(runs_from);
}

static double seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

/* Sleeps while the processor is ahead of the clock. When it is far behind, on a busy machine, the lost time is given up
 * rather than caught up. */
static void keep_real_time(void)
{
    static const double most_behind_s = 0.1;
    static double started_at;
    double now = seconds();
    double simulated = (double)avr->cycle / CLOCK_HZ;
    if (started_at == 0 || now - started_at - simulated > most_behind_s) {
        started_at = now - simulated;
    }
    double ahead_s = started_at + simulated - now;
    if (ahead_s > 0.0005) {
        struct timespec pause = {(time_t)ahead_s, (long)((ahead_s - (double)(time_t)ahead_s) * 1e9)};
        nanosleep(&pause, NULL);
    }
}

/* Says once that the firmware has had the time to begin. */
static void say_when_ready(void)
{
    static bool is_said;
    if (!is_said && avr->cycle >= READY_CYCLES) {
        is_said = true;
        printf("ready\n");
        fflush(stdout);
    }
}

/* Lets the processor go on by a little. Returns false when it has stopped for good. */
static bool processor_runs(void)
{
    if (avr->cycle < runs_from) {
        avr->cycle += POLL_CYCLES;
        return true;
    }
    int state = avr_run(avr);
    return state != cpu_Done && state != cpu_Crashed;
}

static bool run(const struct options *options)
{
    avr_cycle_count_t next_poll = 0, next_flush = 0;
    while (!stop_asked) {
        if (!processor_runs()) {
            fprintf(stderr, "avr_host: the processor has stopped\n");
            return false;
        }
        if (avr->cycle < next_poll) {
            continue;
        }
        next_poll = avr->cycle + POLL_CYCLES;
        say_when_ready();
        if (serial_line_poll()) {
            reset(options->boot_ms);
        }
        if (reset_asked) {
            reset_asked = 0;
            reset(options->boot_ms);
        }
        if (overwrite_asked) {
            overwrite_asked = 0;
            avr->data[stack_begins()] ^= 0xFF;
        }
        if (avr->cycle >= next_flush) {
            next_flush = avr->cycle + FLUSH_CYCLES;
            edges_flush();
        }
        if (!options->free_running) {
            keep_real_time();
        }
    }
    return true;
}

/* Runs until the program sleeps with its interrupts disabled. */
static bool run_batch(void)
{
    int state = cpu_Running;
    while (state != cpu_Done && state != cpu_Crashed && avr->cycle < LONGEST_BATCH_CYCLES && !stop_asked) {
        state = avr_run(avr);
    }
    return state == cpu_Done;
}

/* Runs until the last request has been answered. */
static bool run_conversation(void)
{
    avr_cycle_count_t next_look = 0;
    while (!stop_asked) {
        if (avr->cycle >= next_look) {
            next_look = avr->cycle + LOOK_CYCLES;
            if (!conversation_goes_on()) {
                return true;
            }
        }
        if (!processor_runs()) {
            return false;
        }
    }
    return false;
}

int main(int count, char **words)
{
    struct options options = {.chip = "atmega328p", .timer = "1", .link = "avr-tty"};
    if (!parse_options(count, words, &options) || !chip_choose(options.chip, options.timer[0])) {
        fputs(help, stderr);
        return 2;
    }
    signal(SIGTERM, on_signal);
    signal(SIGINT, on_signal);
    signal(SIGUSR1, on_signal);
    signal(SIGUSR2, on_signal);
    if (!load(&options)) {
        fprintf(stderr, "avr_host: can't begin with %s\n", options.firmware);
        return 2;
    }
    bool good = options.requests ? run_conversation() : options.batch ? run_batch() : run(&options);
    finish(false);
    return good ? 0 : 1;
}
