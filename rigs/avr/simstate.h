/* What the parts of the harness share. Only the C files of this folder include it. */
#ifndef SIMSTATE_H
#define SIMSTATE_H

#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/avr_uart.h>
#include <simavr/avr_watchdog.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_core.h>
#include <simavr/sim_interrupts.h>
#include <simavr/sim_io.h>

#include "simcore.h"

/* A queue that grows: items [head, tail) are waiting. */
#define QUEUE_OF(type)                                                                             \
    struct {                                                                                       \
        type *items;                                                                               \
        size_t head, tail, room;                                                                   \
    }
#define QUEUE_PUSH(queue, item)                                                                    \
    do {                                                                                           \
        if ((queue).tail == (queue).room)                                                          \
            (queue).items = sim_more_room((queue).items, sizeof *(queue).items, &(queue).head,     \
                                          &(queue).tail, &(queue).room);                           \
        (queue).items[(queue).tail++] = (item);                                                    \
    } while (0)
#define QUEUE_EMPTY(queue) ((queue).head == (queue).tail)
#define QUEUE_COUNT(queue) ((queue).tail - (queue).head)

typedef struct {
    uint64_t earliest_cycle;
    uint32_t gap_cycles;
    uint8_t byte;
} fed_t;

typedef struct {
    QUEUE_OF(fed_t) fed;
    QUEUE_OF(sim_event_t) sent;
    double host_bit_cycles; /* 0: as the firmware's */
    uint64_t wire_due;      /* when the frame on the wire ends, or the next one may start */
    int on_wire;            /* the byte being received, or -1 */
    int framing_error;
    uint8_t buffer[2]; /* what UDR0 reads, oldest first */
    int buffered;
    int held; /* a third byte that waits in the shift register, or -1 */
    int tx_shift, tx_buffer;
    uint64_t tx_due;
} uart_t;

typedef struct {
    uint64_t cycle;
    char port;
    uint8_t pin, level;
} pin_change_t;

typedef struct {
    char port; /* 0: not in use */
    uint8_t mask, value;
    int was;
    uint64_t seen;
    sim_watcher_t watcher;
    void *context;
    uint64_t count, delay_cycles; /* for a contact */
    pin_change_t change;
} watch_t;

#define WATCHES 64
typedef struct {
    QUEUE_OF(pin_change_t) due; /* sorted by cycle */
    watch_t watches[WATCHES];
    int watches_end; /* none in use from here on */
    uint8_t driven[3], level[3]; /* per port B C D */
} pins_t;

/* A register whose write goes through us first. */
typedef struct {
    avr_io_write_t write;
    void *param;
} seam_t;

#define TIMERS 3
typedef struct {
    avr_timer_t *timer[TIMERS];
    uint16_t held[TIMERS]; /* the count of a stopped timer */
    seam_t seams[0x100];
} timers_t;

typedef struct {
    sim_t *sim;
    int vector;
} vector_context_t;

typedef struct {
    sim_t *sim;
    char port;
} port_context_t;

struct sim {
    avr_t *avr;
    uint32_t repairs;
    uint64_t run_end;
    int stop_wanted, was_reset, entered;
    uint16_t data_end;
    QUEUE_OF(sim_event_t) log;
    sim_counters_t counters;
    sim_vector_t vectors[SIM_VECTORS];
    uint64_t entered_cycle[SIM_VECTORS];
    vector_context_t vector_contexts[SIM_VECTORS];
    port_context_t port_contexts[3];
    void (*core_reset)(avr_t *avr);
    avr_uart_t *uart_io;
    avr_watchdog_t *watchdog;
    uart_t uart;
    pins_t pins;
    timers_t timers;
};

static inline int sim_repairs(const sim_t *sim, enum sim_repair repair) {
    return (sim->repairs & repair) != 0;
}
static inline sim_t *sim_of(avr_t *avr) { return avr->custom.data; }

void *sim_more_room(void *items, size_t size, size_t *head, size_t *tail, size_t *room);
void sim_log_event(sim_t *sim, uint64_t cycle, uint8_t kind, uint8_t value);
/* Calls `timer` at an absolute cycle, which may have passed. */
void sim_at(sim_t *sim, uint64_t cycle, avr_cycle_timer_t timer);

/* How long the instruction in hand takes that reads or writes a register. */
unsigned sim_access_cycles(const sim_t *sim);

/* Registers of USART0, in the data space. */
enum { UCSR0A = 0xC0, UCSR0B, UCSR0C, UBRR0L = 0xC4, UBRR0H, UDR0 };
enum { UCSR0A_U2X = 0x02 };

void wire_start(sim_t *sim); /* something is to be sent: sees that the line is served */
void wire_sent(sim_t *sim, uint64_t cycle, uint8_t byte);
uint64_t wire_frame_cycles(const sim_t *sim);
void uart_frame_starts(sim_t *sim, uint8_t byte, int framing_error);
void uart_frame_ends(sim_t *sim);

void uart_open(sim_t *sim);
void uart_reset(sim_t *sim);       /* cycle timers are gone: start again */
void uart_after_reset(sim_t *sim); /* registers have been set by the stock core: correct them */
void uart_after_interrupt(sim_t *sim);
void pins_open(sim_t *sim);
void pins_reset(sim_t *sim);
void pins_after_reset(sim_t *sim);
void pins_written(sim_t *sim, uint64_t cycle, char port, uint8_t value);
uint64_t sim_write_cycle(const sim_t *sim);
void timers_open(sim_t *sim);
void timers_reset(sim_t *sim);

#endif
