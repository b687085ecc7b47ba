/* Timers and interrupt flags: where simavr 1.6 departs from the data sheet.
 *
 * Rule 1: every register is written through its seam: ours first, then the stock code, then ours.
 * Rule 2: a flag register is cleared by ones, bit by bit. Stock: any write clears every flag.
 *         SBI touches its own bit only. Stock: it writes back all that read as one.
 * Rule 3: an interrupt is the AND of flag and enable bit, whichever comes last.
 * Rule 4: a stopped timer keeps its count and takes a new one.
 * Rule 5: a timer starts when the instruction that starts it ends, and is read in the last cycle of
 *         the one that reads it: LDS takes two.
 * Rule 6: a match is found at its cycle, also when the overflow just before it is seen late.
 */
#include "simstate.h"

#define TIFR0 0x35
#define TIMSK0 0x6E
#define PINB 0x23
#define PIN_STEP 3
#define OCR1AL 0x88
#define OCR1AH 0x89
#define TCCR1A 0x80
#define TCCR1B 0x81
enum { WGM12 = 0x08, WGM13 = 0x10 };

static const struct {
    uint16_t control_b, count_low, count_high;
} TIMER_REGISTERS[TIMERS] = {{0x45, 0x46, 0}, {0x81, 0x84, 0x85}, {0xB1, 0xB2, 0}};

static void put_seam(sim_t *sim, avr_io_addr_t address, avr_io_write_t write) {
    avr_io_addr_t io = AVR_DATA_TO_IO(address);
    seam_t *seam = &sim->timers.seams[address];
    seam->write = sim->avr->io[io].w.c;
    seam->param = sim->avr->io[io].w.param;
    sim->avr->io[io].w.c = write;
    sim->avr->io[io].w.param = NULL;
}

static void stock_write(sim_t *sim, avr_io_addr_t address, uint8_t value) {
    seam_t *seam = &sim->timers.seams[address];
    if (seam->write)
        seam->write(sim->avr, address, value, seam->param);
    else
        sim->avr->data[address] = value;
}

/* For registers that start something: it starts when the instruction has ended. */
static void stock_write_at_end(sim_t *sim, avr_io_addr_t address, uint8_t value) {
    unsigned access_cycles = sim_access_cycles(sim);
    sim->avr->cycle += access_cycles;
    stock_write(sim, address, value);
    sim->avr->cycle -= access_cycles;
}

/* ---- flags ---- */

/* The bits an instruction means: all of them, but SBI (1001 1010 AAAA Abbb) only its own. */
static uint8_t bits_meant(const avr_t *avr, uint8_t value) {
    unsigned opcode = avr->flash[avr->pc] | avr->flash[avr->pc + 1] << 8;
    return (opcode & 0xFF00) == 0x9A00 ? (uint8_t)(1 << (opcode & 7)) : value;
}

static void write_tifr(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    avr_int_table_t *table = &avr->interrupts;
    uint8_t ones = bits_meant(avr, value);
    for (int i = 0; i < table->vector_count; i++) {
        avr_int_vector_t *vector = table->vector[i];
        if (vector->raised.reg != address || !(ones >> vector->raised.bit & 1))
            continue;
        avr_clear_interrupt(avr, vector);
        avr_regbit_clear(avr, vector->raised);
    }
}

static void write_pin(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    stock_write(sim_of(avr), address, bits_meant(avr, value));
}

/* ---- enabling late ---- */

static void write_timsk(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    avr_int_table_t *table = &avr->interrupts;
    stock_write(sim, address, value);
    for (int i = 0; i < table->vector_count; i++) {
        avr_int_vector_t *vector = table->vector[i];
        if (vector->enable.reg == address && !vector->pending &&
            avr_regbit_get(avr, vector->enable) && avr_regbit_get(avr, vector->raised))
            avr_raise_interrupt(avr, vector);
    }
}

/* ---- stopped timers ---- */

static int timer_of(avr_io_addr_t address) {
    for (int i = 0; i < TIMERS; i++)
        if (TIMER_REGISTERS[i].control_b == address || TIMER_REGISTERS[i].count_low == address)
            return i;
    return 0;
}

static int running(const sim_t *sim, int timer) {
    return (sim->avr->data[TIMER_REGISTERS[timer].control_b] & 7) != 0;
}

static uint16_t current_count(sim_t *sim, int timer) {
    avr_timer_t *io = sim->timers.timer[timer];
    if (!io->tov_cycles || !io->tov_top)
        return io->tov_cycles ? 0 : sim->timers.held[timer];
    unsigned access_cycles = sim_access_cycles(sim);
    uint64_t read_cycle = sim->avr->cycle + (access_cycles ? access_cycles - 1 : 0);
    int64_t elapsed_cycles = (int64_t)(read_cycle - io->tov_base); /* the base may be below 0 */
    if (elapsed_cycles < 0)
        elapsed_cycles = 0;
    return (uint16_t)((uint64_t)elapsed_cycles * (io->tov_top + 1) / io->tov_cycles);
}

static void put_count(sim_t *sim, int timer, uint16_t count) {
    uint16_t low = TIMER_REGISTERS[timer].count_low, high = TIMER_REGISTERS[timer].count_high;
    if (high)
        sim->avr->data[high] = (uint8_t)(count >> 8);
    stock_write_at_end(sim, low, (uint8_t)count);
}

static void write_count(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    int timer = timer_of(address);
    uint16_t high = TIMER_REGISTERS[timer].count_high;
    sim->timers.held[timer] = (uint16_t)(value | (high ? avr->data[high] << 8 : 0));
    stock_write_at_end(sim, address, value);
}

static uint8_t read_count(avr_t *avr, avr_io_addr_t address, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    int timer = timer_of(address);
    uint16_t high = TIMER_REGISTERS[timer].count_high;
    uint16_t count = running(sim, timer) ? current_count(sim, timer) : sim->timers.held[timer];
    if (high)
        avr->data[high] = (uint8_t)(count >> 8);
    return avr->data[address] = (uint8_t)count;
}

/* ---- timer 1 in CTC mode with OCR1A = 0: it stays at 0 and matches on every clock ---- */

static unsigned zero_period_cycles(const sim_t *sim) {
    const uint8_t *data = sim->avr->data;
    static const unsigned divisors[8] = {0, 1, 8, 64, 256, 1024, 0, 0};
    int is_ctc = !(data[TCCR1A] & 3) && (data[TCCR1B] & (WGM12 | WGM13)) == WGM12;
    return is_ctc && !(data[OCR1AL] | data[OCR1AH]) ? divisors[data[TCCR1B] & 7] : 0;
}

static avr_cycle_count_t match_at_zero(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    unsigned period_cycles = zero_period_cycles(sim);
    if (!period_cycles)
        return 0;
    avr_int_vector_t *vector = &sim->timers.timer[1]->comp[0].interrupt;
    if (!avr_regbit_get(avr, vector->raised))
        avr_raise_interrupt(avr, vector);
    return when + period_cycles;
}

static void tick_at_zero_if_so(sim_t *sim) {
    unsigned period_cycles = zero_period_cycles(sim);
    if (period_cycles && !avr_cycle_timer_status(sim->avr, match_at_zero, NULL))
        sim_at(sim, sim->avr->cycle + period_cycles, match_at_zero);
}

/* ---- timer 1 in normal mode with a small OCR1A: stock sets the match up when the overflow is seen,
 *      after the instruction that ran over it; by then it may have passed ---- */

#define LONGEST_CYCLES 16 /* an instruction and an interrupt's entry are shorter */

/* Clocks after an overflow, in cycles, at which it matches; 0: later, or not at all. */
static uint64_t early_match_cycles(const sim_t *sim) {
    const avr_timer_t *io = sim->timers.timer[1];
    uint64_t match_cycles = io->comp[0].comp_cycles;
    int is_normal = io->wgm_op_mode_kind == avr_timer_wgm_normal && io->tov_cycles;
    return is_normal && match_cycles <= LONGEST_CYCLES ? match_cycles : 0;
}

static avr_cycle_count_t match_early(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    avr_timer_t *io = sim->timers.timer[1];
    if (!early_match_cycles(sim))
        return 0;
    if (!avr_regbit_get(avr, io->comp[0].interrupt.raised))
        avr_raise_interrupt(avr, &io->comp[0].interrupt);
    return when + io->tov_cycles;
}

static void expect_early_match(sim_t *sim) {
    const avr_timer_t *io = sim->timers.timer[1];
    uint64_t match_cycles = early_match_cycles(sim);
    avr_cycle_timer_cancel(sim->avr, match_early, NULL);
    if (match_cycles)
        sim_at(sim, io->tov_base + io->tov_cycles + match_cycles, match_early);
}

static void write_ocr1a(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    stock_write(sim, address, value);
    if (sim_repairs(sim, SIM_REPAIR_CTC_ZERO))
        tick_at_zero_if_so(sim);
    if (sim_repairs(sim, SIM_REPAIR_EARLY_MATCH))
        expect_early_match(sim);
}

/* ---- clock select and mode ---- */

/* Stock: every change of clock or mode begins at 0. The silicon counts on. */
static void write_control(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    int timer = timer_of(address);
    int keeps = sim_repairs(sim, SIM_REPAIR_STOPPED_COUNT) && avr->data[address] != value;
    if (keeps && running(sim, timer))
        sim->timers.held[timer] = current_count(sim, timer);
    stock_write_at_end(sim, address, value);
    if (keeps && running(sim, timer) && sim->timers.held[timer])
        put_count(sim, timer, sim->timers.held[timer]);
    if (timer == 1 && sim_repairs(sim, SIM_REPAIR_CTC_ZERO))
        tick_at_zero_if_so(sim);
    if (timer == 1 && sim_repairs(sim, SIM_REPAIR_EARLY_MATCH))
        expect_early_match(sim);
}

/* ---- reset and open ---- */

void timers_reset(sim_t *sim) {
    for (int i = 0; i < TIMERS; i++)
        sim->timers.held[i] = 0;
}

static void open_counts(sim_t *sim) {
    for (int i = 0; i < TIMERS; i++) {
        avr_io_addr_t count = TIMER_REGISTERS[i].count_low;
        put_seam(sim, count, write_count);
        sim->avr->io[AVR_DATA_TO_IO(count)].r.c = read_count;
        sim->avr->io[AVR_DATA_TO_IO(count)].r.param = NULL;
    }
}

void timers_open(sim_t *sim) {
    for (int i = 0; i < TIMERS; i++) {
        put_seam(sim, TIMER_REGISTERS[i].control_b, write_control);
        if (sim_repairs(sim, SIM_REPAIR_FLAG_WRITES)) {
            put_seam(sim, (avr_io_addr_t)(TIFR0 + i), write_tifr);
            put_seam(sim, (avr_io_addr_t)(PINB + PIN_STEP * i), write_pin);
        }
        if (sim_repairs(sim, SIM_REPAIR_LATE_ENABLE))
            put_seam(sim, (avr_io_addr_t)(TIMSK0 + i), write_timsk);
    }
    if (sim_repairs(sim, SIM_REPAIR_STOPPED_COUNT))
        open_counts(sim);
    if (sim_repairs(sim, SIM_REPAIR_CTC_ZERO) || sim_repairs(sim, SIM_REPAIR_EARLY_MATCH))
        put_seam(sim, OCR1AL, write_ocr1a);
}
