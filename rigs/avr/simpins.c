/* Pins: what the firmware writes is logged and watched, what the world drives is scheduled.
 *
 * Rule 1: a level set for cycle n is seen by the first IN that begins at or after n.
 * Rule 2: levels from outside stay through a reset and through writes to the port's other pins.
 * Rule 3: a write is dated when its instruction ends, for that is when the pins move:
 *
 *            OUT          SBI, CBI, ST, STS
 *          |--1--|        |--1--|--2--|
 *                ^ here               ^ here
 */
#include "simstate.h"

static const struct {
    char name;
    uint16_t pin_register;
} PORTS[3] = {{'B', 0x23}, {'C', 0x26}, {'D', 0x29}};

uint64_t sim_write_cycle(const sim_t *sim) {
    return sim->avr->cycle + sim_access_cycles(sim);
}

/* ---- levels from outside ---- */

static void apply_level(sim_t *sim, char port, int pin, int level) {
    avr_t *avr = sim->avr;
    pins_t *pins = &sim->pins;
    int index = port - 'B';
    uint8_t bit = (uint8_t)(1 << pin);
    pins->driven[index] |= bit;
    pins->level[index] = (uint8_t)((pins->level[index] & ~bit) | (level ? bit : 0));
    if (sim_repairs(sim, SIM_REPAIR_DRIVEN_PINS)) {
        avr_ioport_external_t external = {.name = port,
                                          .mask = pins->driven[index],
                                          .value = pins->level[index] & pins->driven[index]};
        avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(port), &external);
    }
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(port), pin), level ? 1 : 0);
}

static avr_cycle_count_t apply_due(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    pins_t *pins = &sim->pins;
    while (!QUEUE_EMPTY(pins->due) && pins->due.items[pins->due.head].cycle <= avr->cycle) {
        pin_change_t change = pins->due.items[pins->due.head++];
        apply_level(sim, change.port, change.pin, change.level);
    }
    if (QUEUE_EMPTY(pins->due))
        return 0;
    uint64_t next_cycle = pins->due.items[pins->due.head].cycle;
    return next_cycle > when ? next_cycle : when + 1;
}

static void schedule(sim_t *sim, pin_change_t change) {
    pins_t *pins = &sim->pins;
    QUEUE_PUSH(pins->due, change);
    size_t i = pins->due.tail - 1;
    for (; i > pins->due.head && pins->due.items[i - 1].cycle > change.cycle; i--)
        pins->due.items[i] = pins->due.items[i - 1];
    pins->due.items[i] = change;
    sim_at(sim, pins->due.items[pins->due.head].cycle, apply_due);
}

void sim_set_pin(sim_t *sim, char port, int pin, int level) { apply_level(sim, port, pin, level); }

void sim_schedule_pin(sim_t *sim, uint64_t cycle, char port, int pin, int level) {
    schedule(sim, (pin_change_t){cycle, port, (uint8_t)pin, (uint8_t)level});
}

/* ---- watches ---- */

static int new_watch(sim_t *sim, watch_t watch) {
    for (int i = 0; i < WATCHES; i++)
        if (!sim->pins.watches[i].port) {
            sim->pins.watches[i] = watch;
            if (i >= sim->pins.watches_end)
                sim->pins.watches_end = i + 1;
            return i;
        }
    return -1;
}

int sim_contact(sim_t *sim, char port, uint8_t mask, uint8_t value, uint64_t count,
                uint64_t delay_cycles, char pin_port, int pin, int level) {
    return new_watch(sim, (watch_t){.port = port,
                                    .mask = mask,
                                    .value = value,
                                    .count = count,
                                    .delay_cycles = delay_cycles,
                                    .change = {0, pin_port, (uint8_t)pin, (uint8_t)level}});
}

int sim_watch(sim_t *sim, char port, uint8_t mask, uint8_t value, sim_watcher_t watcher,
              void *context) {
    return new_watch(sim, (watch_t){.port = port,
                                    .mask = mask,
                                    .value = value,
                                    .watcher = watcher,
                                    .context = context});
}

uint64_t sim_watch_count(const sim_t *sim, int watch) { return sim->pins.watches[watch].seen; }
void sim_unwatch(sim_t *sim, int watch) { sim->pins.watches[watch].port = 0; }

static void fulfil(sim_t *sim, watch_t *watch, uint64_t cycle, uint8_t value) {
    watch->seen++;
    if (watch->watcher) {
        watch->watcher(watch->context, cycle, (uint8_t)watch->port, value);
    } else if (watch->seen == watch->count) {
        pin_change_t change = watch->change;
        change.cycle = cycle + watch->delay_cycles;
        schedule(sim, change);
    }
}

void pins_written(sim_t *sim, uint64_t cycle, char port, uint8_t value) {
    for (int i = 0; i < sim->pins.watches_end; i++) {
        watch_t *watch = &sim->pins.watches[i];
        if (watch->port != port)
            continue;
        int now = (value & watch->mask) == watch->value;
        int became = now && !watch->was;
        watch->was = now;
        if (became)
            fulfil(sim, watch, cycle, value);
    }
}

static void port_written(avr_irq_t *irq, uint32_t value, void *param) {
    (void)irq;
    port_context_t *context = param;
    uint64_t cycle = sim_write_cycle(context->sim);
    sim_log_event(context->sim, cycle, (uint8_t)context->port, (uint8_t)value);
    pins_written(context->sim, cycle, context->port, (uint8_t)value);
}

static void direction_written(avr_irq_t *irq, uint32_t value, void *param) {
    (void)irq;
    port_context_t *context = param;
    uint8_t kind = (uint8_t)(context->port - 'B' + 'b');
    sim_log_event(context->sim, sim_write_cycle(context->sim), kind, (uint8_t)value);
}

/* ---- reset and open ---- */

void pins_reset(sim_t *sim) {
    for (int i = 0; i < WATCHES; i++)
        sim->pins.watches[i].was = 0;
    if (!QUEUE_EMPTY(sim->pins.due))
        sim_at(sim, sim->pins.due.items[sim->pins.due.head].cycle, apply_due);
}

void pins_after_reset(sim_t *sim) {
    for (int i = 0; i < 3; i++)
        sim->avr->data[PORTS[i].pin_register] = sim->pins.level[i];
}

void pins_open(sim_t *sim) {
    avr_t *avr = sim->avr;
    for (int i = 0; i < 3; i++) {
        char name = PORTS[i].name;
        sim->port_contexts[i] = (port_context_t){sim, name};
        avr_irq_t *written =
            avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(name), IOPORT_IRQ_REG_PORT);
        avr_irq_t *direction =
            avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(name), IOPORT_IRQ_DIRECTION_ALL);
        if (sim_repairs(sim, SIM_REPAIR_EQUAL_WRITES)) {
            written->flags &= (uint8_t)~IRQ_FLAG_FILTERED;
            direction->flags &= (uint8_t)~IRQ_FLAG_FILTERED;
        }
        avr_irq_register_notify(written, port_written, &sim->port_contexts[i]);
        avr_irq_register_notify(direction, direction_written, &sim->port_contexts[i]);
    }
}
