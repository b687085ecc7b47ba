/* Life of a simulated microcontroller: open, run, reset, interrupts, log.
 *
 * Rule 1: time is avr->cycle. Inside an instruction it is the cycle the instruction began with.
 * Rule 2: the core runs in batches up to the next cycle timer, so a timer due at cycle n is
 *         processed before the first instruction that begins at or after n. Batches never change
 *         what happens, only how fast.
 * Rule 3: a reset empties simavr's list of cycle timers. Whoever has one waiting puts it in
 *         again in its *_reset function. Registers that the stock reset sets wrongly are
 *         corrected in *_after_reset.
 *
 * An interrupt, in cycles (ATmega328P data sheet, 7.7.1 "Interrupt Response Time"):
 *
 *    flag        entry 4          vector: jmp 3
 *     |  <- end of |----|----|----|----|----|----|----| handler ... RETI 4
 *     |   instr.   ^ counted from here                            ^ to here
 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <simavr/avr_extint.h>
#include <simavr/sim_elf.h>

#include "simstate.h"

#define ENTRY_CYCLES 4
#define RETI_CYCLES 4
#define WAKE_CYCLES 4
#define BATCH_CYCLES 1000
#define SRAM_START 0x100
#define STACK_PATTERN 0xC5
#define MCUSR 0x54
enum { POWER_ON = 1, RESET_PIN = 2, WATCHDOG = 8 };

void *sim_more_room(void *items, size_t size, size_t *head, size_t *tail, size_t *room) {
    if (*head > *room / 2) {
        memmove(items, (char *)items + *head * size, (*tail - *head) * size);
        *tail -= *head;
        *head = 0;
        return items;
    }
    *room = *room ? *room * 2 : 1024;
    items = realloc(items, *room * size);
    if (!items)
        abort();
    return items;
}

void sim_log_event(sim_t *sim, uint64_t cycle, uint8_t kind, uint8_t value) {
    sim_event_t event = {cycle, kind, value, {0}};
    QUEUE_PUSH(sim->log, event);
}

void sim_at(sim_t *sim, uint64_t cycle, avr_cycle_timer_t timer) {
    uint64_t now = sim->avr->cycle;
    avr_cycle_timer_register(sim->avr, cycle > now ? cycle - now : 0, timer, NULL);
}

unsigned sim_access_cycles(const sim_t *sim) {
    if (!sim_repairs(sim, SIM_REPAIR_WRITE_END))
        return 0;
    return (sim->avr->flash[sim->avr->pc + 1] & 0xF0) == 0xB0 ? 1 : 2; /* IN and OUT, or another */
}

/* simavr prints what it loads; only what is wrong is of interest. */
static void log_errors(avr_t *avr, const int level, const char *format, va_list arguments) {
    (void)avr;
    if (level <= LOG_ERROR)
        vfprintf(stderr, format, arguments);
}

/* ---- interrupts ---- */

static void vector_running(avr_irq_t *irq, uint32_t entered, void *param) {
    (void)irq;
    vector_context_t *context = param;
    sim_t *sim = context->sim;
    avr_t *avr = sim->avr;
    sim_vector_t *vector = &sim->vectors[context->vector];
    if (entered) {
        sim->entered_cycle[context->vector] = avr->cycle;
        sim->entered = 1;
        if (sim_repairs(sim, SIM_REPAIR_ENTRY))
            avr->cycle += ENTRY_CYCLES;
        return;
    }
    uint64_t spent_cycles = avr->cycle + RETI_CYCLES - sim->entered_cycle[context->vector];
    vector->count++;
    vector->total_cycles += spent_cycles;
    if (spent_cycles > vector->max_cycles)
        vector->max_cycles = spent_cycles;
    uart_after_interrupt(sim);
}

static void watch_vectors(sim_t *sim) {
    avr_int_table_t *table = &sim->avr->interrupts;
    for (int i = 0; i < table->vector_count; i++) {
        int number = table->vector[i]->vector;
        if (number >= SIM_VECTORS)
            continue;
        sim->vector_contexts[number] = (vector_context_t){sim, number};
        avr_irq_register_notify(table->vector[i]->irq + AVR_INT_IRQ_RUNNING, vector_running,
                                &sim->vector_contexts[number]);
    }
}

/* After SEI and RETI simavr counts -2, -1, 0 and then looks only one instruction later. An entry
 * in its list that is no longer pending costs an instruction too. The silicon has neither. */
static void serve_interrupts(sim_t *sim) {
    avr_t *avr = sim->avr;
    int waiting = avr->interrupt_state < 0;
    sim->entered = 0;
    avr_service_interrupts(avr);
    if (sim_repairs(sim, SIM_REPAIR_SHADOW) && !(waiting && avr->interrupt_state < 0))
        while (!sim->entered && avr->interrupt_state > 0 && avr->sreg[S_I])
            avr_service_interrupts(avr);
    if (sim->entered)
        avr_cycle_timer_process(avr); /* what fell due during the entry */
}

/* ---- running ---- */

static void sleep_until(sim_t *sim, uint64_t next_timer_cycles) {
    avr_t *avr = sim->avr;
    if (!sim_repairs(sim, SIM_REPAIR_SLEEP)) {
        avr->sleep(avr, next_timer_cycles);
        avr->cycle += 1 + next_timer_cycles;
        return;
    }
    uint64_t left_cycles = sim->run_end - avr->cycle;
    uint64_t cycles = next_timer_cycles < left_cycles ? next_timer_cycles : left_cycles;
    avr->cycle += cycles;
    sim->counters.slept_cycles += cycles;
}

static void after_reset(sim_t *sim) {
    sim->was_reset = 0;
    uart_after_reset(sim);
    pins_after_reset(sim);
}

/* One batch of instructions: what simavr calls for avr_run. */
static void run_batch(avr_t *avr) {
    sim_t *sim = sim_of(avr);
    if (sim->was_reset)
        after_reset(sim);
    avr_flashaddr_t new_pc = avr->pc;
    int slept = avr->state == cpu_Sleeping;
    sim->counters.batches++;
    if (avr->state == cpu_Running) {
        uint64_t left_cycles = sim->run_end > avr->cycle ? sim->run_end - avr->cycle : 1;
        if (avr->run_cycle_count > left_cycles)
            avr->run_cycle_count = left_cycles;
        new_pc = avr_run_one(avr);
    }
    uint64_t next_timer_cycles = avr_cycle_timer_process(avr);
    avr->pc = new_pc;
    if (avr->state == cpu_Sleeping && avr->sreg[S_I])
        sleep_until(sim, next_timer_cycles);
    else if (avr->state == cpu_Sleeping)
        avr->state = cpu_Done; /* nothing can wake it */
    else if (slept && sim_repairs(sim, SIM_REPAIR_SLEEP))
        avr->cycle += WAKE_CYCLES;
    if (avr->interrupt_state && (avr->state == cpu_Running || avr->state == cpu_Sleeping))
        serve_interrupts(sim);
}

int sim_run(sim_t *sim, uint64_t cycles) {
    avr_t *avr = sim->avr;
    sim->run_end = avr->cycle + cycles;
    sim->stop_wanted = 0;
    int state = avr->state;
    while (avr->cycle < sim->run_end && !sim->stop_wanted) {
        state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed)
            break;
    }
    return state == cpu_Running || state == cpu_Sleeping;
}

void sim_stop(sim_t *sim) {
    sim->stop_wanted = 1;
    sim->avr->run_cycle_count = 1;
}

/* ---- reset ---- */

/* In the middle of avr_reset: registers are zero, cycle timers gone, the modules come after us. */
static void on_reset(avr_t *avr) {
    sim_t *sim = sim_of(avr);
    sim->core_reset(avr);
    avr->run_cycle_limit = BATCH_CYCLES; /* the stock reset makes every batch one instruction */
    uint8_t cause = sim->watchdog->reset_context.wdrf ? WATCHDOG : RESET_PIN;
    sim_log_event(sim, avr->cycle, 'R', sim->counters.resets++ ? cause : POWER_ON);
    uart_reset(sim);
    pins_reset(sim);
    timers_reset(sim);
    sim->was_reset = 1;
}

void sim_reset(sim_t *sim) {
    sim->watchdog->reset_context.wdrf = 0;
    sim->avr->run = run_batch;
    avr_reset(sim->avr);
    sim->avr->data[MCUSR] |= RESET_PIN;
}

/* ---- open and close ---- */

static void find_modules(sim_t *sim) {
    for (avr_io_t *io = sim->avr->io_port; io; io = io->next)
        if (!strcmp(io->kind, "uart"))
            sim->uart_io = (avr_uart_t *)io;
        else if (!strcmp(io->kind, "watchdog"))
            sim->watchdog = (avr_watchdog_t *)io;
        else if (!strcmp(io->kind, "timer"))
            sim->timers.timer[((avr_timer_t *)io)->name - '0'] = (avr_timer_t *)io;
}

static void forget(elf_firmware_t *image) {
    for (uint32_t i = 0; i < image->symbolcount; i++)
        free(image->symbol[i]);
    free(image->symbol);
    free(image->flash);
}

static void load(sim_t *sim, elf_firmware_t *image) {
    avr_t *avr = sim->avr;
    avr_init(avr);
    avr_load_firmware(avr, image);
    avr->frequency = SIM_F_CPU_HZ;
    avr->log = LOG_ERROR;
    avr->run = run_batch;
    /* SRAM holds anything at power-on; where the pattern is gone, something was written. */
    memset(avr->data + SRAM_START, STACK_PATTERN, avr->ramend + 1 - SRAM_START);
    sim->data_end = SRAM_START + image->datasize + image->bsssize;
    forget(image); /* it was copied */
}

sim_t *sim_open(const char *elf_path, uint32_t repairs) {
    elf_firmware_t image;
    memset(&image, 0, sizeof image);
    avr_global_logger_set(log_errors);
    if (elf_read_firmware(elf_path, &image) || !image.flashsize)
        return NULL;
    sim_t *sim = calloc(1, sizeof *sim);
    sim->repairs = repairs;
    sim->avr = avr_make_mcu_by_name("atmega328p");
    if (!sim->avr) {
        free(sim);
        return NULL;
    }
    sim->avr->custom.data = sim;
    load(sim, &image);
    find_modules(sim);
    watch_vectors(sim);
    uart_open(sim);
    pins_open(sim);
    timers_open(sim);
    sim->core_reset = sim->avr->reset;
    sim->avr->reset = on_reset;
    avr_reset(sim->avr);
    sim->avr->data[MCUSR] |= POWER_ON;
    if (sim_repairs(sim, SIM_REPAIR_LEVEL_POLL)) {
        avr_extint_set_strict_lvl_trig(sim->avr, 0, 0);
        avr_extint_set_strict_lvl_trig(sim->avr, 1, 0);
    }
    return sim;
}

void sim_close(sim_t *sim) {
    avr_terminate(sim->avr);
    free(sim->avr);
    free(sim->log.items);
    free(sim->uart.fed.items);
    free(sim->uart.sent.items);
    free(sim->pins.due.items);
    free(sim);
}

/* ---- what was seen ---- */

uint64_t sim_cycle(const sim_t *sim) { return sim->avr->cycle; }
uint32_t sim_pc(const sim_t *sim) { return sim->avr->pc; }
uint8_t *sim_data(sim_t *sim) { return sim->avr->data; }
uint16_t sim_data_end(const sim_t *sim) { return sim->data_end; }
const sim_counters_t *sim_counters(const sim_t *sim) { return &sim->counters; }
const sim_vector_t *sim_vectors(const sim_t *sim) { return sim->vectors; }

size_t sim_log(const sim_t *sim, const sim_event_t **events) {
    *events = sim->log.items;
    return sim->log.tail;
}

void sim_clear_log(sim_t *sim) { sim->log.tail = 0; }

uint16_t sim_stack_low(const sim_t *sim) {
    uint16_t address = sim->data_end;
    while (address <= sim->avr->ramend && sim->avr->data[address] == STACK_PATTERN)
        address++;
    return address;
}
