// The timer interrupt: a beat of a phase card in as few cycles as it takes.
//
//   match            due
//     |--- wait -----|out out out ... in|-- next beat made out --| compare set, line polled
//     |<EARLY_CYCLES>|  motor 1, 2, 3   |
//
// Rule 1: registers r2 to r15 belong to this interrupt alone// the rest of the firmware is compiled
//         without them (-ffixed). So seven `movw` save what pushes would take 28 cycles for.
// Rule 2: only what is usual is done here: a beat with movements, a tick within its piece, nothing
//         wished. All else is called in C, after r0 and r1 are saved and r1 cleared.
// Rule 3: structures are those of layout.h// this file decides nothing that C does not decide the
//         same way (player.c: play_slowly, prepare).
// Rule 4: the strobe is low for 8 cycles, half a microsecond// the loads of the next motor fill it.

#define __SFR_OFFSET 0
#include <avr/io.h>
#include "board.h"
#include "layout.h"

    .data
    .balign 64
    .global tracks                  // struct tracks: in one page, since data begins a page
tracks:
    .space TRACKS_SIZE
    .balign 32
    .global beat                    // struct beat, likewise
beat:
    .space BEAT_SIZE
    .text

#define STROBE_LOW (0xFF & ~(1 << STROBE_BIT))

// Counter to `due` in r25:r24: waits// leaves IS_LATE and player.late if it was too late.
.macro wait_out
    lds  r22, TCNT1L
    lds  r23, TCNT1H
    sub  r24, r22
    sbc  r25, r23
    adiw r24, 16
    brmi 7f
1:  subi r24, 3
    brcc 1b
    cpi  r24, 0xFE
    brsh 2f
2:  cpi  r24, 0xFF
    brsh 3f
3:  rjmp 8f
7:  com  r24
    com  r25
    sts  player + PLAYER_LATE, r24
    sts  player + PLAYER_LATE + 1, r25
    sbi  _SFR_IO_ADDR(GPIOR0), 7
8:
.endm

// One movement: r18 low, r19 high; afterwards they are those of the next one. While the strobe is
// low, the reading before (r23) is kept and compared with r26, what is quiet; r25 gathers.
.macro movement number
    out  _SFR_IO_ADDR(PORT_LOW), r18
    mov  r21, r19
    out  _SFR_IO_ADDR(PORT_HIGH), r19
    andi r21, STROBE_LOW
    out  _SFR_IO_ADDR(PORT_HIGH), r21
    lds  r18, beat + BEAT_ENTRY * (\number + 1)
    lds  r22, beat + BEAT_ENTRY * (\number + 1) + 1
.if \number
    sts  beat + BEAT_PINS + \number - 1, r23
    eor  r23, r26
    or   r25, r23
.else
    rjmp .+0
    rjmp .+0
.endif
    out  _SFR_IO_ADDR(PORT_HIGH), r19
    in   r23, _SFR_IO_ADDR(PIN_STATUS)
    mov  r19, r22
    cpi  r20, lo8(beat + BEAT_ENTRY * (\number + 1))
.endm

// The mover at Y + offset moves on in the table// its bytes go to X, its bit to r25.
.macro move offset
    ldd  r30, Y + \offset
    ldd  r23, Y + \offset + 1
    ldd  r22, Z + MOTOR_PHASE
    add  r22, r23
    lds  r23, card + CARD_TABLE_LENGTH
    cp   r22, r23
    brlo 6f
    breq 5f
    dec  r23
    mov  r22, r23
    rjmp 6f
5:  clr  r22
6:  std  Z + MOTOR_PHASE, r22
    ldd  r23, Z + MOTOR_HIGH
#if DATA_HIGH_MASK
    ldd  r24, Z + MOTOR_BIT
    subi r22, lo8(-(tracks))
    mov  r30, r22
    ld   r22, Z
#else                               // the motor bits are in the same port as the table's
    ldd  r24, Z + MOTOR_LOW
    subi r22, lo8(-(tracks))
    mov  r30, r22
    ld   r22, Z
    or   r22, r24
    ldd  r30, Y + \offset
    ldd  r24, Z + MOTOR_BIT
#endif
    or   r25, r24
    st   X+, r22
    st   X+, r23
    st   X+, r24
.endm

.macro minor number
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_SUM
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD
    add  r22, r30
    ldd  r23, Y + MINOR_SIZE * \number + MINOR_SUM + 1
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD + 1
    adc  r23, r30
    ldd  r24, Y + MINOR_SIZE * \number + MINOR_SUM + 2
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD + 2
    adc  r24, r30
    brcs 3f
    std  Y + MINOR_SIZE * \number + MINOR_SUM, r22
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 1, r23
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 2, r24
    rjmp 4f
3:  ldd  r30, Y + BLOCK_LIMIT
    sub  r22, r30
    ldd  r30, Y + BLOCK_LIMIT + 1
    sbc  r23, r30
    ldd  r30, Y + BLOCK_LIMIT + 2
    sbc  r24, r30
    std  Y + MINOR_SIZE * \number + MINOR_SUM, r22
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 1, r23
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 2, r24
    move (MINOR_SIZE * \number + MINOR_MOVER)
4:
.endm

// A byte has come, the UART's status is in r22: line_take() of line.h. Uses r21, r23, Z.
.macro receive_byte
    lds  r30, line + LINE_HEAD
    ldi  r31, 0
    mov  r21, r30
    subi r30, lo8(-(line + LINE_BYTES))
    sbci r31, hi8(-(line + LINE_BYTES))
    lds  r23, UDR0
    st   Z, r23
    inc  r21
    andi r21, LINE_RING - 1
    sts  line + LINE_HEAD, r21
    andi r22, (1 << FE0) | (1 << DOR0)
    breq 1f
    lds  r23, line + LINE_ERRORS
    inc  r23
    sts  line + LINE_ERRORS, r23
1:
.endm

.macro call_c function
    push r0
    push r1
    clr  r1
    call \function
    pop  r1
    pop  r0
.endm

.global TIMER1_COMPA_vect
TIMER1_COMPA_vect:
    movw r2, r24
    movw r4, r30
    movw r6, r18
    movw r8, r20
    movw r10, r22
    movw r12, r26
    movw r14, r28
    in   r24, _SFR_IO_ADDR(SREG)
    out  _SFR_IO_ADDR(GPIOR1), r24

again:
    lds  r25, player + PLAYER_MODE
    cpi  r25, MODE_PHASES
    breq phases
    cpi  r25, MODE_FAST_RISE
    brlo 1f
    breq jump_rise
    rjmp fall
jump_rise:
    rjmp rise
1:
    call_c player_play              // anything but a usual beat
    rjmp called

phases:
    lds  r18, beat
    lds  r19, beat + 1
    lds  r20, beat + BEAT_END
    lds  r24, player + PLAYER_DUE
    lds  r25, player + PLAYER_DUE + 1
    lds  r26, beat + BEAT_QUIET
    lds  r27, beat + BEAT_RESTLESS
    wait_out
    mov  r25, r27
    movement 0
    ldi  r30, lo8(beat + BEAT_PINS)
    breq written
    movement 1
    ldi  r30, lo8(beat + BEAT_PINS + 1)
    breq written
    movement 2
    ldi  r30, lo8(beat + BEAT_PINS + 2)
    breq written
    movement 3
    ldi  r30, lo8(beat + BEAT_PINS + 3)
written:
    lds  r24, beat + BEAT_MIND
    mov  r27, r23
    eor  r23, r26
    or   r25, r23
    and  r25, r24
    breq examined
    ldi  r31, hi8(beat + BEAT_PINS) // all of beat is in one page
    st   Z, r27
    call_c inputs_examine_beat
examined:
    lds  r20, player + PLAYER_BEATS_LEFT
    sbic _SFR_IO_ADDR(GPIOR0), 7
    rjmp late
not_late:
    tst  r20
    breq tick_done
    lds  r24, player + PLAYER_MOVED
    lds  r25, beat + BEAT_MASK
    or   r24, r25
    sts  player + PLAYER_MOVED, r24
    rjmp prepare

slow_tick:
    call_c player_tick
called:                             // r24: 0, the timer is stopped; 0xFF: it is set; or beats
    tst  r24
    breq jump_restore
    mov  r20, r24
    cpi  r24, 0xFF
    breq finish
    rjmp prepare
finish:
    lds  r24, OCR1AL
    lds  r25, OCR1AH
    rjmp poll
jump_restore:
    rjmp restore

tick_done:
    sts  player + PLAYER_MOVED, r20
    lds  r18, player + PLAYER_DONE
    lds  r19, player + PLAYER_DONE + 1
    lds  r20, player + PLAYER_DONE + 2
    subi r18, 0xFF
    sbci r19, 0xFF
    sbci r20, 0xFF
    sts  player + PLAYER_DONE, r18
    sts  player + PLAYER_DONE + 1, r19
    sts  player + PLAYER_DONE + 2, r20
    lds  r21, player + PLAYER_PIECE_END
    cp   r18, r21
    lds  r21, player + PLAYER_PIECE_END + 1
    cpc  r19, r21
    lds  r21, player + PLAYER_PIECE_END + 2
    cpc  r20, r21
    breq slow_tick
    in   r24, _SFR_IO_ADDR(GPIOR0)
    lds  r25, player + PLAYER_RAMPS
    cpi  r25, RAMP_SLOW
    breq slow_tick
    tst  r24
    brne slow_tick
    lds  r20, player + PLAYER_BEATS
    tst  r25
    breq prepare
    rjmp ramp

prepare:                            // r20: beats left
    lds  r28, player + PLAYER_BLOCK
    lds  r29, player + PLAYER_BLOCK + 1
    ldi  r26, lo8(beat)
    ldi  r27, hi8(beat)
    ldi  r31, hi8(tracks)
    clr  r18
    clr  r19
    clr  r25
next_beat:
    lds  r22, player + PLAYER_BEAT_CYCLES
    lds  r23, player + PLAYER_BEAT_CYCLES + 1
    add  r18, r22
    adc  r19, r23
    ldd  r21, Y + BLOCK_MINORS
    dec  r20
    brne minors
    lds  r22, player + PLAYER_LAG
    add  r18, r22
    brcc 1f
    inc  r19
1:  move BLOCK_LEADER
minors:
    dec  r21
    brpl 1f
    rjmp minors_done
1:  minor 0
    dec  r21
    brpl 1f
    rjmp minors_done
1:  minor 1
    dec  r21
    brmi minors_done
    minor 2
minors_done:
    tst  r20
    breq prepared
    tst  r25
    brne prepared
    lds  r22, UCSR0A                // many empty beats take longer than two bytes
    sbrc r22, RXC0
    rjmp take_byte_early
    rjmp next_beat
prepared:
    sts  player + PLAYER_BEATS_LEFT, r20
    sts  beat + BEAT_MASK, r25
    sts  beat + BEAT_END, r26
prepared_wait:                      // r19:r18 after the deadline before
    lds  r24, player + PLAYER_DUE
    lds  r25, player + PLAYER_DUE + 1
    add  r24, r18
    adc  r25, r19
    sts  player + PLAYER_DUE, r24
    sts  player + PLAYER_DUE + 1, r25
    lds  r22, player + PLAYER_EARLY
    sub  r24, r22
    sbci r25, 0
    sts  OCR1AH, r25
    sts  OCR1AL, r24
poll:
    lds  r22, UCSR0A
    sbrc r22, RXC0
    rjmp take_byte
polled:
    lds  r22, TCNT1L
    lds  r23, TCNT1H
    sub  r24, r22
    sbc  r25, r23
    sbiw r24, NEAR_CYCLES
    brlt too_near
restore:
    in   r24, _SFR_IO_ADDR(GPIOR1)
    out  _SFR_IO_ADDR(SREG), r24
    movw r28, r14
    movw r26, r12
    movw r22, r10
    movw r20, r8
    movw r18, r6
    movw r30, r4
    movw r24, r2
    reti

too_near:                           // the match may have passed: play on from here
    lds  r24, player + PLAYER_PATIENCE
    dec  r24
    sts  player + PLAYER_PATIENCE, r24
    breq give_way
    sbi  _SFR_IO_ADDR(TIFR1), OCF1A
    rjmp again

// The main loop has had no turn for long: it gets some instructions, whatever comes late by it.
give_way:
    ldi  r24, PATIENCE
    sts  player + PLAYER_PATIENCE, r24
    lds  r22, TCNT1L
    lds  r23, TCNT1H
    subi r22, lo8(-(GIVEN_CYCLES))
    sbci r23, hi8(-(GIVEN_CYCLES))
    sts  OCR1AH, r23
    sts  OCR1AL, r22
    sbi  _SFR_IO_ADDR(TIFR1), OCF1A
    rjmp restore

take_byte:
    receive_byte
    rjmp polled
take_byte_early:
    receive_byte
    ldi  r31, hi8(tracks)
    rjmp next_beat

// The interval changes from tick to tick// its number of beats seldom does.
ramp:
    lds  r18, player + PLAYER_INTERVAL
    lds  r22, player + PLAYER_ADD
    add  r18, r22
    sts  player + PLAYER_INTERVAL, r18
    lds  r18, player + PLAYER_INTERVAL + 1
    lds  r22, player + PLAYER_ADD + 1
    adc  r18, r22
    sts  player + PLAYER_INTERVAL + 1, r18
    lds  r19, player + PLAYER_INTERVAL + 2
    lds  r22, player + PLAYER_ADD + 2
    adc  r19, r22
    sts  player + PLAYER_INTERVAL + 2, r19
    lds  r21, player + PLAYER_INTERVAL + 3
    lds  r22, player + PLAYER_ADD + 3
    adc  r21, r22
    sts  player + PLAYER_INTERVAL + 3, r21
    lds  r22, player + PLAYER_CYCLES
    sts  player + PLAYER_LAST, r22
    lds  r22, player + PLAYER_CYCLES + 1
    sts  player + PLAYER_LAST + 1, r22
    tst  r21
    brne ramp_slowly
    sts  player + PLAYER_LAST + 2, r21
    sts  player + PLAYER_LAST + 3, r21
    cpi  r19, FAR_HIGH
    brsh ramp_slowly
    sts  player + PLAYER_CYCLES, r18
    sts  player + PLAYER_CYCLES + 1, r19
    movw r22, r18
    ldi  r21, 1
    lds  r24, player + PLAYER_SHORTEST // twice the shortest beat// 0xFFFF: ticks are not divided
    lds  r25, player + PLAYER_SHORTEST + 1
1:  cpi  r21, 8
    breq 2f
    cp   r22, r24
    cpc  r23, r25
    brlo 2f
    lsr  r23
    ror  r22
    lsl  r21
    rjmp 1b
2:  cp   r21, r20
    brne ramp_slowly
    sts  player + PLAYER_BEAT_CYCLES, r22
    sts  player + PLAYER_BEAT_CYCLES + 1, r23
    dec  r21
    and  r21, r18
    sts  player + PLAYER_LAG, r21
    rjmp prepare

// The tick is chosen (player.interval_q8), but not as usual.
ramp_slowly:
    call_c player_tick_chosen
    mov  r20, r24
    cpi  r24, 0xFF
    breq 1f
    rjmp prepare
1:  rjmp finish

// A write came late: from a quarter of the interval on it is counted, and all that follows moves
// (player.c: note_late).
late:
    cbi  _SFR_IO_ADDR(GPIOR0), 7
    lds  r22, player + PLAYER_LATE
    lds  r23, player + PLAYER_LATE + 1
    lds  r24, player + PLAYER_CYCLES
    lds  r25, player + PLAYER_CYCLES + 1
    lsr  r25
    ror  r24
    tst  r20
    brne 1f                         // a minor axis alone: half of it
    lsr  r25
    ror  r24
1:  cp   r24, r22
    cpc  r25, r23
    brsh 3f
    lds  r30, player + PLAYER_LATE_TICKS
    lds  r31, player + PLAYER_LATE_TICKS + 1
    adiw r30, 1
    sts  player + PLAYER_LATE_TICKS, r30
    sts  player + PLAYER_LATE_TICKS + 1, r31
    lds  r24, player + PLAYER_DUE
    lds  r25, player + PLAYER_DUE + 1
    add  r24, r22
    adc  r25, r23
    sts  player + PLAYER_DUE, r24
    sts  player + PLAYER_DUE + 1, r25
3:  rjmp not_late

// ---- Clock lines: an edge, half an interval later the fall; then the next interval is chosen.

// r18, r19: two port bytes, at their cycle.
.macro write_pair_at_due
    lds  r24, player + PLAYER_DUE
    lds  r25, player + PLAYER_DUE + 1
    wait_out
    nop                             // as long as a beat of a phase card
    out  _SFR_IO_ADDR(PORT_LOW), r18
    out  _SFR_IO_ADDR(PORT_HIGH), r19
.endm

// The next deadline is r19:r18 after this one, its mode r20.
set_timer:
    sts  player + PLAYER_MODE, r20
    rjmp prepared_wait

rise:
    lds  r18, beat
    lds  r19, beat + 1
    write_pair_at_due
    in   r23, _SFR_IO_ADDR(PIN_STATUS)
    sts  beat + BEAT_PINS, r23
    lds  r24, beat + BEAT_QUIET
    eor  r23, r24
    lds  r24, beat + BEAT_RESTLESS
    or   r23, r24
    lds  r24, beat + BEAT_MIND
    and  r23, r24
    breq 1f
    call_c inputs_examine_beat
1:  sbic _SFR_IO_ADDR(GPIOR0), 7
    rjmp late_rise
rise_counted:
    lds  r18, player + PLAYER_DONE
    lds  r19, player + PLAYER_DONE + 1
    lds  r20, player + PLAYER_DONE + 2
    subi r18, 0xFF
    sbci r19, 0xFF
    sbci r20, 0xFF
    sts  player + PLAYER_DONE, r18
    sts  player + PLAYER_DONE + 1, r19
    sts  player + PLAYER_DONE + 2, r20
    lds  r25, player + PLAYER_RAMPS
    cpi  r25, RAMP_STEADY
    brne 5f
    lds  r18, player + PLAYER_FALL
    lds  r19, player + PLAYER_FALL + 1
    rjmp fall_known
5:  cpi  r25, RAMP_FAST
    brne 2f
    lds  r18, player + PLAYER_INTERVAL
    lds  r22, player + PLAYER_ADD
    add  r18, r22
    sts  player + PLAYER_INTERVAL, r18
    lds  r18, player + PLAYER_INTERVAL + 1
    lds  r22, player + PLAYER_ADD + 1
    adc  r18, r22
    sts  player + PLAYER_INTERVAL + 1, r18
    lds  r18, player + PLAYER_INTERVAL + 2
    lds  r22, player + PLAYER_ADD + 2
    adc  r18, r22
    sts  player + PLAYER_INTERVAL + 2, r18
    lds  r18, player + PLAYER_INTERVAL + 3
    lds  r22, player + PLAYER_ADD + 3
    adc  r18, r22
    sts  player + PLAYER_INTERVAL + 3, r18
2:  lds  r18, player + PLAYER_PLAN
    lds  r19, player + PLAYER_PLAN + 1
    lsr  r19
    ror  r18
    lds  r22, card + CARD_PULSE
    lds  r23, card + CARD_PULSE + 1
    cp   r18, r22
    cpc  r19, r23
    brsh 3f
    movw r18, r22
3:  sts  player + PLAYER_FALL, r18
    sts  player + PLAYER_FALL + 1, r19
    add  r22, r18
    adc  r23, r19
    sts  player + PLAYER_NOT_BEFORE, r22
    sts  player + PLAYER_NOT_BEFORE + 1, r23
fall_known:
    lds  r24, player + PLAYER_DONE
    lds  r22, player + PLAYER_PIECE_END
    cp   r24, r22
    breq 4f                         // perhaps the end of the piece: then C sees to it
    rcall make_out
    ldi  r24, 1
    sts  player + PLAYER_IS_MADE_OUT, r24
4:  ldi  r20, MODE_FAST_FALL
    rjmp set_timer

// Up to a quarter of its interval a write may be late without more ado; of a fall's, an eighth of
// the whole.
.macro excuse shifts back
    lds  r22, player + PLAYER_LATE
    lds  r23, player + PLAYER_LATE + 1
    lds  r24, player + PLAYER_CYCLES
    lds  r25, player + PLAYER_CYCLES + 1
.rept \shifts
    lsr  r25
    ror  r24
.endr
    cbi  _SFR_IO_ADDR(GPIOR0), 7
    cp   r24, r22
    cpc  r25, r23
    brlo 1f
    rjmp \back
1:  call_c player_clocks_late
    rjmp \back
.endm
late_rise:
    excuse 2 rise_counted
late_fall:
    excuse 3 fallen
slow_fall:
    call_c player_fell
    rjmp called

fall:
    lds  r18, beat + BEAT_REST
    lds  r19, beat + BEAT_REST + 1
    write_pair_at_due
    sbic _SFR_IO_ADDR(GPIOR0), 7
    rjmp late_fall
    rjmp fallen
jump_slow_fall:
    rjmp slow_fall
fallen:
    lds  r18, player + PLAYER_DONE
    lds  r21, player + PLAYER_PIECE_END
    cp   r18, r21
    lds  r18, player + PLAYER_DONE + 1
    lds  r21, player + PLAYER_PIECE_END + 1
    cpc  r18, r21
    lds  r18, player + PLAYER_DONE + 2
    lds  r21, player + PLAYER_PIECE_END + 2
    cpc  r18, r21
    breq jump_slow_fall
    in   r24, _SFR_IO_ADDR(GPIOR0)
    tst  r24
    brne jump_slow_fall
    lds  r25, player + PLAYER_RAMPS
    cpi  r25, RAMP_SLOW
    breq jump_slow_fall
    lds  r18, player + PLAYER_WAIT
    lds  r19, player + PLAYER_WAIT + 1
    ldi  r20, 0
    cpi  r25, RAMP_STEADY
    breq wait_known
    lds  r20, player + PLAYER_INTERVAL + 3
    tst  r20
    brne jump_slow_fall
    lds  r18, player + PLAYER_INTERVAL + 1
    lds  r19, player + PLAYER_INTERVAL + 2
    cpi  r19, FAR_HIGH
    brsh jump_slow_fall
    sts  player + PLAYER_PLAN, r18
    sts  player + PLAYER_PLAN + 1, r19
    lds  r22, player + PLAYER_NOT_BEFORE
    lds  r23, player + PLAYER_NOT_BEFORE + 1
    cp   r18, r22
    cpc  r19, r23
    brsh 1f
    movw r18, r22
1:  lds  r22, player + PLAYER_CYCLES
    sts  player + PLAYER_LAST, r22
    lds  r22, player + PLAYER_CYCLES + 1
    sts  player + PLAYER_LAST + 1, r22
    sts  player + PLAYER_CYCLES, r18
    sts  player + PLAYER_CYCLES + 1, r19
    lds  r22, player + PLAYER_FALL
    lds  r23, player + PLAYER_FALL + 1
    sub  r18, r22
    sbc  r19, r23
    cpi  r25, RAMP_FAST
    breq wait_known
    sts  player + PLAYER_WAIT, r18
    sts  player + PLAYER_WAIT + 1, r19
    ldi  r24, RAMP_STEADY
    tst  r25
    brne 1f
    ldi  r24, RAMP_SETTLING
1:  sts  player + PLAYER_RAMPS, r24
wait_known:
    lds  r24, player + PLAYER_IS_MADE_OUT
    tst  r24
    breq jump_make_out
    sts  player + PLAYER_IS_MADE_OUT, r20
to_rise:
    ldi  r20, MODE_FAST_RISE
    rjmp set_timer
jump_make_out:
    rcall make_out
    rjmp to_rise

// The motors of the next edge, into beat. Keeps r18 and r19.
make_out:
    lds  r28, player + PLAYER_BLOCK
    lds  r29, player + PLAYER_BLOCK + 1
    ldd  r25, Y + BLOCK_LEADER + 1  // motors
    lds  r26, card + CARD_DATA      // data byte
    ldd  r24, Y + BLOCK_LEADER
    eor  r26, r24
    ldd  r21, Y + BLOCK_MINORS
.macro clock_minor number
    dec  r21
    brpl 1f
    rjmp clocks_done
1:  ldd  r22, Y + MINOR_SIZE * \number + MINOR_SUM
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD
    add  r22, r30
    ldd  r23, Y + MINOR_SIZE * \number + MINOR_SUM + 1
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD + 1
    adc  r23, r30
    ldd  r24, Y + MINOR_SIZE * \number + MINOR_SUM + 2
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD + 2
    adc  r24, r30
    brcc 2f
    ldd  r30, Y + BLOCK_LIMIT
    sub  r22, r30
    ldd  r30, Y + BLOCK_LIMIT + 1
    sbc  r23, r30
    ldd  r30, Y + BLOCK_LIMIT + 2
    sbc  r24, r30
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_MOVER
    eor  r26, r30
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_MOVER + 1
    or   r25, r30
2:  std  Y + MINOR_SIZE * \number + MINOR_SUM, r22
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 1, r23
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 2, r24
.endm
    clock_minor 0
    clock_minor 1
    clock_minor 2
clocks_done:
    lds  r24, card + CARD_CONTROL_HIGH
#if DATA_HIGH_MASK                  // D0 to D5 from bit 2 on, D6 and D7 elsewhere
    mov  r23, r26
    swap r23
    lsr  r23
    lsr  r23
    andi r23, DATA_HIGH_MASK
    or   r24, r23
    lsl  r26
    lsl  r26
    ori  r26, 0x01
#endif
    sts  beat, r26
    sts  beat + 1, r24
    sts  beat + 2, r25
    sts  beat + BEAT_MASK, r25
    ret
