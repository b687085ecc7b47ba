/* The main loop: the line, what lies ahead, the life of a run, reports; and what happens at reset.
 *
 *   reset -> pins harmless -> watchdog on -> loop: receive, throttle, reader, run, reports, send
 *
 * Rule 1: no turn of the loop takes long; the watchdog resets a loop that hangs for 250 ms.
 * Rule 2: at a reset nothing is known: pins made harmless first, motors off, session 0.
 * Rule 3: MCUSR says why the reset came. Optiboot clears it and hands it over in r2; a boot loader
 *         that does neither leaves 0.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>

#include "card.h"
#include "commands.h"
#include "frames.h"
#include "inputs.h"
#include "line.h"
#include "player.h"
#include "power.h"
#include "reader.h"
#include "run.h"
#include "throttle.h"

#define RESET_BITS 0x0F

/* Not cleared at a reset: counts resets while power stays on, and is a nonce after power-on. */
static uint16_t boots __attribute__((section(".noinit")));
static uint8_t reset_reason __attribute__((section(".noinit")));

/* Before memory is cleared: the watchdog may still be running with its shortest time. */
static void __attribute__((naked, used, section(".init3"))) look_at_reset(void)
{
    uint8_t handed_over;
    __asm__ __volatile__("mov %0, r2" : "=r"(handed_over));
    uint8_t reason = MCUSR;
    MCUSR = 0;
    wdt_disable();
    reset_reason = (reason ? reason : handed_over) & RESET_BITS;
}

static void begin(void)
{
    card_after_reset();
    boots++;
    commands_begin(reset_reason, boots);
    line_begin();
    TCCR1A = 0;
    TCCR1B = _BV(CS10);
    WANT = 0;
    throttle.override_q8 = 256;
    inputs_begin();
    reader_forget();
    run_forget();
    wdt_enable(WDTO_250MS);
    sei();
}

/* With so many bytes waiting, no record is looked at before some of them are taken. */
#define MANY_BYTES 36

/* What must have its turn more often than once in a loop. The next block goes before bytes, while
 * these are few: the motors wait for it, the host does not. */
static void mind_line(void)
{
    if (!player_has_block() && line_waiting() < MANY_BYTES)
        reader_service();
    if (player.halt == STARVED)
        run_service(); /* what was waited for may be there: reports can wait */
    frames_receive();
    frames_send();
    throttle_service();
}

int main(void)
{
    begin();
    for (;;) {
        wdt_reset();
        player.patience = PATIENCE;
        run_time();
        mind_line();
        reader_service();
        mind_line();
        run_service();
        power_service();
        mind_line();
        reports_service();
    }
}
