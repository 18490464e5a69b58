/* The serial line between a pseudo-terminal and the processor's UART. Unlike simavr's own, it takes 10 bits a byte, and
 * loses what the firmware doesn't fetch in time: a UART holds two bytes and the one that is coming in. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <simavr/avr_uart.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_io.h>

#include "host.h"

/* Of the UART's registers. */
enum { STATUS = 0, CONTROL = 1, RATE_LOW = 4, RATE_HIGH = 5, U2X = 2, RXEN = 1 << 4, RXCIE = 1 << 7 };
enum { FIRST_BUSY_BYTE_CYCLES = 1000 };
enum { BITS_OF_BYTE = 10, UART_HOLDS = 3, QUEUE_BYTES = 65536 };

struct queue {
    uint8_t bytes[QUEUE_BYTES];
    uint16_t in, out; /* they wrap with the queue */
};

static avr_t *avr;
static avr_uart_t *uart;
static avr_irq_t *uart_input;
static int terminal;
static const char *link_name;
static bool opening_resets, was_open, byte_is_coming;
static struct termios raw;
static struct queue to_avr, to_terminal;
static avr_cycle_count_t deaf_until;
static avr_cycle_count_t asked_at; /* when the last zero byte, which ends a frame, arrived; 0: answered */
static uint8_t control; /* the control register as it was written last */
static struct serial_counts counts;
static void (*sent_to)(uint8_t byte);

/* The UART's own time for a byte; simavr counts 11 bits. */
static void on_baud_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)address, (void)unused;
    unsigned divider = (mcu->data[chip->uart_registers + RATE_HIGH] << 8 | value) + 1;
    uart->cycles_per_byte = (avr_cycle_count_t)BITS_OF_BYTE * divider * (mcu->data[chip->uart_registers + STATUS] & U2X ? 8 : 16);
}

static unsigned bytes_in_uart(void)
{
    unsigned size = sizeof uart->input.buffer / sizeof uart->input.buffer[0];
    return (uart->input.write + size - uart->input.read) % size;
}

/* simavr forgets a byte that comes while its interrupt is disabled. The real one interrupts once it is enabled again. */
static void on_control_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    bool was_masked = !(control & RXCIE);
    control = value;
    mcu->data[address] = value;
    if ((value & RXCIE) && was_masked && bytes_in_uart() > 0 && !uart->rxc.pending) {
        avr_raise_interrupt(mcu, &uart->rxc);
    }
}

/* A byte has come over the line; the next one follows at once. */
static avr_cycle_count_t on_byte_arrived(avr_t *mcu, avr_cycle_count_t when, void *unused)
{
    (void)unused;
    uint8_t byte = to_avr.bytes[to_avr.out++];
    counts.received++;
    asked_at = byte == 0 ? mcu->cycle : asked_at;
    if (bytes_in_uart() >= UART_HOLDS) {
        counts.lost++;
    } else {
        avr_raise_irq(uart_input, byte);
    }
    byte_is_coming = to_avr.in != to_avr.out;
    return byte_is_coming ? when + uart->cycles_per_byte : 0;
}

/* Bytes without end, as from a client that asks and asks. They begin with the receiver. */
static avr_cycle_count_t on_busy_byte(avr_t *mcu, avr_cycle_count_t when, void *unused)
{
    (void)unused;
    if (!(mcu->data[chip->uart_registers + CONTROL] & RXEN)) {
        return when + uart->cycles_per_byte;
    }
    if (bytes_in_uart() >= UART_HOLDS) {
        counts.lost++;
    } else {
        avr_raise_irq(uart_input, (uint8_t)counts.received);
    }
    counts.received++;
    return when + uart->cycles_per_byte;
}

static void on_byte_sent_to_file(avr_irq_t *irq, uint32_t byte, void *file)
{
    (void)irq;
    counts.sent++;
    if (file) {
        fputc((int)byte, file);
    }
}

/* Counts a byte that the processor sends. */
static void count_sent(void)
{
    counts.sent++;
    if (asked_at != 0 && avr->cycle - asked_at > counts.longest_answer) {
        counts.longest_answer = avr->cycle - asked_at;
    }
    asked_at = 0;
}

static void on_byte_sent(avr_irq_t *irq, uint32_t byte, void *unused)
{
    (void)irq, (void)unused;
    count_sent();
    to_terminal.bytes[to_terminal.in++] = (uint8_t)byte;
}

static void on_byte_sent_on(avr_irq_t *irq, uint32_t byte, void *unused)
{
    (void)irq, (void)unused;
    count_sent();
    sent_to((uint8_t)byte);
}

static bool open_terminal(void)
{
    char name[64];
    int other_side;
    if (openpty(&terminal, &other_side, name, NULL, NULL) != 0) {
        perror("pseudo-terminal");
        return false;
    }
    tcgetattr(terminal, &raw);
    cfmakeraw(&raw);
    tcsetattr(terminal, TCSANOW, &raw);
    fcntl(terminal, F_SETFL, O_NONBLOCK);
    if (opening_resets) {
        close(other_side); /* so that POLLHUP tells whether somebody has opened it */
    }
    unlink(link_name);
    if (symlink(name, link_name) != 0) {
        perror(link_name);
        return false;
    }
    return true;
}

static void attach_uart(avr_t *mcu)
{
    uint32_t no_flags = 0; /* neither an echo on the console nor a sleep at each poll */
    avr = mcu;
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS(chip->uart), &no_flags);
    for (avr_io_t *io = avr->io_port; io; io = io->next) {
        if (strcmp(io->kind, "uart") == 0 && ((avr_uart_t *)io)->name == chip->uart) {
            uart = (avr_uart_t *)io;
        }
    }
    avr_register_io_write(avr, chip->uart_registers + RATE_LOW, on_baud_write, &counts);
    avr_register_io_write(avr, chip->uart_registers + CONTROL, on_control_write, &control);
    uart_input = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ(chip->uart), UART_IRQ_INPUT);
}

bool serial_line_attach(avr_t *mcu, const char *link, unsigned boot_ms)
{
    attach_uart(mcu);
    link_name = link;
    opening_resets = boot_ms > 0;
    was_open = !opening_resets;
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ(chip->uart), UART_IRQ_OUTPUT), on_byte_sent, NULL);
    return open_terminal();
}

void serial_line_attach_to_file(avr_t *mcu, FILE *sent, bool is_busy)
{
    attach_uart(mcu);
    avr_irq_t *output = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ(chip->uart), UART_IRQ_OUTPUT);
    avr_irq_register_notify(output, on_byte_sent_to_file, sent);
    if (is_busy) {
        avr_cycle_timer_register(avr, FIRST_BUSY_BYTE_CYCLES, on_busy_byte, NULL);
    }
}

void serial_line_attach_to(avr_t *mcu, void (*on_sent)(uint8_t byte))
{
    attach_uart(mcu);
    sent_to = on_sent;
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ(chip->uart), UART_IRQ_OUTPUT), on_byte_sent_on, NULL);
}

void serial_line_send(const uint8_t *bytes, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        to_avr.bytes[to_avr.in++] = bytes[i];
    }
    if (count > 0 && !byte_is_coming) {
        byte_is_coming = true;
        avr_cycle_timer_register(avr, uart->cycles_per_byte, on_byte_arrived, NULL);
    }
}

avr_cycle_count_t serial_line_byte_cycles(void)
{
    return uart->cycles_per_byte;
}

static void read_terminal(void)
{
    uint8_t bytes[4096];
    uint16_t room = (uint16_t)(to_avr.out - to_avr.in - 1);
    ssize_t count = read(terminal, bytes, room < sizeof bytes ? room : sizeof bytes);
    if (avr->cycle < deaf_until) {
        return;
    }
    serial_line_send(bytes, count > 0 ? (unsigned)count : 0);
}

/* What nobody listens to is lost, as on a real line. */
static void write_terminal(bool is_open)
{
    while (to_terminal.in != to_terminal.out) {
        if (is_open && write(terminal, &to_terminal.bytes[to_terminal.out], 1) < 0 && errno == EAGAIN) {
            return;
        }
        to_terminal.out++;
    }
}

bool serial_line_poll(void)
{
    struct pollfd events = {terminal, POLLIN, 0};
    poll(&events, 1, 0);
    bool is_open = !opening_resets || !(events.revents & POLLHUP);
    bool was_just_opened = is_open && !was_open;
    was_open = is_open;
    if (was_just_opened) {
        tcsetattr(terminal, TCSANOW, &raw);
    }
    if (is_open && (events.revents & POLLIN)) {
        read_terminal();
    }
    write_terminal(is_open);
    return was_just_opened;
}

void serial_line_deaf_until(avr_cycle_count_t cycle)
{
    deaf_until = cycle;
}

void serial_line_reset(void)
{
    control = 0;
    byte_is_coming = false;
    to_avr.out = to_avr.in;
}

void serial_line_detach(void)
{
    if (link_name) {
        write_terminal(true);
        unlink(link_name);
    }
}

struct serial_counts serial_line_counts(void)
{
    return counts;
}
