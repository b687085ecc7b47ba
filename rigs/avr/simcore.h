/* The ATmega328P on the bench: libsimavr 1.6, repaired where it is kinder than the silicon.
 *
 * Everything is counted in cycles of the 16 MHz clock since power-on. The same image and the same
 * calls give the same cycles every time. Nothing here looks at the wall clock.
 *
 * One sim_t is one microcontroller; a process may have several.
 */
#ifndef SIMCORE_H
#define SIMCORE_H

#include <stddef.h>
#include <stdint.h>

#define SIM_F_CPU_HZ 16000000u
#define SIM_VECTORS 32

/* What is repaired. README.md says why, one by one. The self-tests switch them off in turn. */
enum sim_repair {
    SIM_REPAIR_ENTRY = 1 << 0,         /* interrupt entry costs 4 cycles */
    SIM_REPAIR_SHADOW = 1 << 1,        /* one instruction after SEI and RETI, not two */
    SIM_REPAIR_UART = 1 << 2,          /* simuart.c instead of the stock USART */
    SIM_REPAIR_EQUAL_WRITES = 1 << 3,  /* port writes of an unchanged value are seen */
    SIM_REPAIR_LATE_ENABLE = 1 << 4,   /* enabling an interrupt whose flag is set fires it */
    SIM_REPAIR_CTC_ZERO = 1 << 5,      /* timer 1 in CTC with OCR1A = 0 matches */
    SIM_REPAIR_STOPPED_COUNT = 1 << 6, /* a stopped timer keeps its count, and takes writes */
    SIM_REPAIR_LEVEL_POLL = 1 << 7,    /* no polling of INT0 and INT1 in every cycle */
    SIM_REPAIR_DRIVEN_PINS = 1 << 8,   /* a pull-up does not win against what drives the pin */
    SIM_REPAIR_FLAG_WRITES = 1 << 9,   /* TIFRn and PINn: only the ones written count */
    SIM_REPAIR_SLEEP = 1 << 10,        /* sleep without the wall clock, wake-up in 4 cycles */
    SIM_REPAIR_WRITE_END = 1 << 11,    /* a write is dated when its instruction ends */
    SIM_REPAIR_EARLY_MATCH = 1 << 12,  /* a match just after an overflow is not missed */
    SIM_REPAIR_ALL = (1 << 13) - 1,
};

/* Kinds of event in the log: 'B' 'C' 'D' a port was written, 'b' 'c' 'd' its direction register
 * was, 'R' a reset with the cause as MCUSR shows it, 'T' a byte left the transmitter. */
typedef struct {
    uint64_t cycle;
    uint8_t kind;
    uint8_t value;
    uint8_t unused[6];
} sim_event_t;

typedef struct {
    uint64_t rx_bytes;       /* frames that arrived, kept or lost */
    uint64_t tx_bytes;       /* frames that left */
    uint64_t overruns;       /* frames lost because nobody read in time (DOR) */
    uint64_t unheard;        /* frames lost because the receiver was off */
    uint64_t framing_errors; /* frames without a stop bit: wrong baud rate */
    uint64_t tx_dropped;     /* UDR0 written while it was full */
    uint64_t resets;         /* power-on included */
    uint64_t slept_cycles;
    uint64_t batches; /* of instructions: what a run costs us, not the AVR */
} sim_counters_t;

typedef struct {
    uint64_t count;
    uint64_t total_cycles; /* entry and RETI included; nested interrupts too */
    uint64_t max_cycles;
} sim_vector_t;

/* Called from inside sim_run, in the middle of the writing instruction. */
typedef void (*sim_watcher_t)(void *context, uint64_t cycle, uint8_t kind, uint8_t value);

typedef struct sim sim_t;

/* Life. sim_open answers NULL when the image cannot be read. */
sim_t *sim_open(const char *elf_path, uint32_t repairs);
void sim_close(sim_t *sim);
void sim_reset(sim_t *sim); /* the reset pin */
int sim_run(sim_t *sim, uint64_t cycles); /* answers 1 while the core is alive */
void sim_stop(sim_t *sim);                /* ends a run after the instruction in hand */
uint64_t sim_cycle(const sim_t *sim);

/* What was seen. */
size_t sim_log(const sim_t *sim, const sim_event_t **events);
void sim_clear_log(sim_t *sim);
const sim_counters_t *sim_counters(const sim_t *sim);
const sim_vector_t *sim_vectors(const sim_t *sim);

/* Memory. Addresses are the data space: registers from 0, I/O from 0x20, SRAM from 0x100. */
uint8_t *sim_data(sim_t *sim);
uint16_t sim_data_end(const sim_t *sim);  /* first address behind .data and .bss */
uint16_t sim_stack_low(const sim_t *sim); /* lowest address that was ever written above that */
uint32_t sim_pc(const sim_t *sim);

/* The wire. A byte starts when the line is free, `gap_cycles` after the last one, not before
 * `earliest_cycle`. `bit_cycles` 0: the host's baud rate is what the firmware has set. */
void sim_feed(sim_t *sim, const uint8_t *bytes, size_t count, uint64_t earliest_cycle,
              uint32_t gap_cycles);
size_t sim_backlog(const sim_t *sim); /* bytes not yet arrived */
void sim_drop_backlog(sim_t *sim);
size_t sim_take(sim_t *sim, sim_event_t *sent, size_t room); /* cycle: end of the stop bit */
void sim_host_bit_cycles(sim_t *sim, double bit_cycles);
double sim_bit_cycles(const sim_t *sim); /* as the firmware has set it */

/* The pins. */
void sim_set_pin(sim_t *sim, char port, int pin, int level);
void sim_schedule_pin(sim_t *sim, uint64_t cycle, char port, int pin, int level);
/* Counts how often (written & mask) becomes `value`. At the `count`th time, the pin is set
 * `delay_cycles` after the write. */
int sim_contact(sim_t *sim, char port, uint8_t mask, uint8_t value, uint64_t count,
                uint64_t delay_cycles, char pin_port, int pin, int level);
/* The same, but somebody is called, every time. */
int sim_watch(sim_t *sim, char port, uint8_t mask, uint8_t value, sim_watcher_t watcher,
              void *context);
uint64_t sim_watch_count(const sim_t *sim, int watch);
void sim_unwatch(sim_t *sim, int watch);

#endif
