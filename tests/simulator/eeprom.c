/* simavr writes EEPROM in no time and knows no erase-only and write-only modes. This one takes the time of the data
 * sheet and keeps every byte in a file as soon as it is written. */
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <simavr/avr_eeprom.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_io.h>

#include "host.h"

enum { EECR = 0x3F, EEDR = 0x40, EEARL = 0x41, EEARH = 0x42 };
enum { EEPE = 2, EEMPE = 4 };
enum { EEPROM_BYTES = 1024, ERASED = 0xFF };
enum mode { ERASE_AND_WRITE = 0, ERASE_ONLY = 1, WRITE_ONLY = 2 };
enum { ERASE_AND_WRITE_US = 3400, HALF_OF_IT_US = 1800 };
enum { ARMED_CYCLES = 6 /* EEPE must follow EEMPE within four cycles; the two instructions take two each */ };

static uint8_t bytes[EEPROM_BYTES];
static int file_descriptor = -1;
static long writes, cut_write;
static void (*power_cut)(void);
static avr_cycle_count_t armed_at;

static void give_to_simavr(avr_t *avr)
{
    avr_eeprom_desc_t all = {.ee = bytes, .offset = 0, .size = sizeof bytes};
    avr_ioctl(avr, AVR_IOCTL_EEPROM_SET, &all);
}

static void keep(unsigned address)
{
    if (file_descriptor >= 0 && pwrite(file_descriptor, bytes + address, 1, address) != 1) {
        perror("EEPROM file");
    }
}

static avr_cycle_count_t on_written(avr_t *avr, avr_cycle_count_t when, void *unused)
{
    (void)when, (void)unused;
    avr->data[EECR] &= (uint8_t)~EEPE;
    return 0;
}

static void begin_write(avr_t *avr, enum mode mode)
{
    unsigned address = (avr->data[EEARL] | avr->data[EEARH] << 8) % EEPROM_BYTES;
    uint8_t value = avr->data[EEDR];
    if (++writes == cut_write) {
        bytes[address] = ERASED;
        keep(address);
        power_cut();
    }
    bytes[address] = mode == ERASE_ONLY ? ERASED : mode == WRITE_ONLY ? bytes[address] & value : value;
    keep(address);
    give_to_simavr(avr);
    avr->data[EECR] |= EEPE;
    avr_cycle_timer_register_usec(avr, mode == ERASE_AND_WRITE ? ERASE_AND_WRITE_US : HALF_OF_IT_US, on_written, NULL);
}

/* Runs after simavr's own function. */
static void on_control_write(avr_t *avr, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)address, (void)unused;
    if ((value & (EEMPE | EEPE)) == EEMPE) {
        armed_at = avr->cycle;
    } else if ((value & EEPE) && armed_at && avr->cycle - armed_at <= ARMED_CYCLES) {
        armed_at = 0;
        begin_write(avr, (enum mode)(value >> 4 & 3));
    }
}

/* A file that is missing or short begins as an erased EEPROM. */
static bool open_file(const char *file)
{
    file_descriptor = open(file, O_RDWR | O_CREAT, 0644);
    if (file_descriptor < 0) {
        return false;
    }
    if (read(file_descriptor, bytes, sizeof bytes) == sizeof bytes) {
        return true;
    }
    memset(bytes, ERASED, sizeof bytes);
    return pwrite(file_descriptor, bytes, sizeof bytes, 0) == sizeof bytes;
}

bool eeprom_attach(avr_t *avr, const char *file, long cut_at, void (*on_power_cut)(void))
{
    cut_write = cut_at;
    power_cut = on_power_cut;
    memset(bytes, ERASED, sizeof bytes);
    if (file && !open_file(file)) {
        perror(file);
        return false;
    }
    give_to_simavr(avr);
    avr_register_io_write(avr, EECR, on_control_write, bytes);
    return true;
}

long eeprom_writes(void)
{
    return writes;
}
