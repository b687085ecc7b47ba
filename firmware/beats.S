// The timer interrupt: a beat of a phase card in as few cycles as it takes.
//
//   match            due
//     |--- wait -----|out out out ... in|-- next beat made out --| compare set, line polled
//     |<EARLY_CYCLES>|  motor 1, 2, 3   |
//
// Rule 1: registers r2 to r15 belong to this interrupt alone; the rest of the firmware is compiled
//         without them (-ffixed). So seven `movw` save what pushes would take 28 cycles for.
// Rule 2: only what is usual is done here: a beat with movements, a tick within its piece, nothing
//         wished. All else is called in C, after r0 and r1 are saved and r1 cleared.
// Rule 3: structures are those of layout.h; this file decides nothing that C does not decide the
//         same way (player.c: play_slowly; makeout.c).
// Rule 4: the strobe is low for 8 cycles at least, half a microsecond; the loads of the next motor
//         fill it.
// Rule 5: Y is the block in hand wherever its time law is spoken of. So a block is gone over to by a
//         pointer, at the price of two movements.
// Rule 6: sums of minors take 16 bits in a block that is short enough (narrow), else 24 (wide).

#define __SFR_OFFSET 0
#include <avr/io.h>
#include "board.h"
#include "layout.h"

#define WANT _SFR_IO_ADDR(GPIOR0)
#define IS_THROTTLED 4
#define MAY_RUN_DRY 6
#define IS_LATE 7
#define SAVED_SREG _SFR_IO_ADDR(GPIOR1)
#define MODE _SFR_IO_ADDR(GPIOR2)

    .data                           // begins a page: layout.ld sees to it that this is its begin
    .global tracks                  // struct tracks: a phase is the low byte of its entry's address
tracks:
    .space TRACKS_SIZE
    .global beat                    // struct beat: in the same page
beat:
    .space BEAT_SIZE
    .text

// Counter to `due` in r25:r24: waits; leaves IS_LATE and player.late if it was too late.
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
    adiw r24, 4                     // 1, and what this way is longer than the other
    sts  player + PLAYER_LATE, r24
    sts  player + PLAYER_LATE + 1, r25
    sbi  WANT, IS_LATE
8:
.endm

// One movement: r18 low, r19 high; afterwards they are those of the next one, and r23 is the
// reading. While the strobe is low, the reading before is compared with r26, what is quiet: r25
// gathers the differences, `kept` keeps it.
.macro movement number kept
    out  _SFR_IO_ADDR(PORT_LOW), r18
    out  _SFR_IO_ADDR(PORT_HIGH), r19
    cbi  _SFR_IO_ADDR(PORT_HIGH), STROBE_BIT
    lds  r18, beat + BEAT_ENTRY * (\number + 1)
    lds  r19, beat + BEAT_ENTRY * (\number + 1) + 1
.if \number
    eor  r23, r26
    or   r25, r23
    mov  \kept, r23
.else
    lds  r26, beat + BEAT_QUIET
    lds  r25, beat + BEAT_RESTLESS
.endif
    sbi  _SFR_IO_ADDR(PORT_HIGH), STROBE_BIT
    in   r23, _SFR_IO_ADDR(PIN_STATUS)
    cpi  r20, lo8(beat + BEAT_ENTRY * (\number + 1))
.endm

// The mover at Y + offset moves on in the table; its bytes go to X, its bit to r25.
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
    ldd  r23, Z + MOTOR_BIT
    or   r25, r23
    ldd  r23, Z + MOTOR_HIGH
#if DATA_HIGH_MASK
    mov  r30, r22
    ld   r22, Z
#else                               // the motor bits are in the same port as the table's
    ldd  r24, Z + MOTOR_LOW
    mov  r30, r22
    ld   r22, Z
    or   r22, r24
#endif
    st   X+, r22
    st   X+, r23
.endm

// A minor's sum goes on, in r23:r22 or r24:r23:r22; a carry is a step, and the limit is taken off.
.macro load_sum number bytes
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_SUM
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD
    add  r22, r30
    ldd  r23, Y + MINOR_SIZE * \number + MINOR_SUM + 1
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD + 1
    adc  r23, r30
.if \bytes == 3
    ldd  r24, Y + MINOR_SIZE * \number + MINOR_SUM + 2
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_ADD + 2
    adc  r24, r30
.endif
.endm

.macro store_sum number bytes
    std  Y + MINOR_SIZE * \number + MINOR_SUM, r22
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 1, r23
.if \bytes == 3
    std  Y + MINOR_SIZE * \number + MINOR_SUM + 2, r24
.endif
.endm

.macro take_off_limit bytes
    ldd  r30, Y + BLOCK_LIMIT
    sub  r22, r30
    ldd  r30, Y + BLOCK_LIMIT + 1
    sbc  r23, r30
.if \bytes == 3
    ldd  r30, Y + BLOCK_LIMIT + 2
    sbc  r24, r30
.endif
.endm

// One minor, or the end of them at `done`.
.macro minor number bytes done
    dec  r21
    brpl 1f
    rjmp \done
1:  load_sum \number \bytes
    brcs 3f
    store_sum \number \bytes
    rjmp 4f
3:  take_off_limit \bytes
    store_sum \number \bytes
.if \bytes == 2
    move (MINOR_SIZE * \number + MINOR_MOVER)
.else
    adiw r28, MINOR_SIZE * \number + MINOR_MOVER
    rcall move_at_y
    sbiw r28, MINOR_SIZE * \number + MINOR_MOVER
.endif
4:
.endm

// A byte has come, the UART's status is in r22: line_poll() of line.h. Uses r21, r23, Z.
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

.macro load_block
    lds  r28, player + PLAYER_BLOCK
    lds  r29, player + PLAYER_BLOCK + 1
.endm

// Of player.done, and of the piece's end in r21, to another byte.
.macro load_done byte
    lds  r18, player + PLAYER_DONE + \byte
    ldd  r21, Y + BLOCK_PIECE_END + \byte
.endm

// A tick more is done, r18 of them in the lowest byte; to `carried` if there are more to count.
.macro count_tick carried
    lds  r18, player + PLAYER_DONE
    inc  r18
    sts  player + PLAYER_DONE, r18
    breq \carried
.endm

.macro count_higher back
    lds  r19, player + PLAYER_DONE + 1
    inc  r19
    sts  player + PLAYER_DONE + 1, r19
    brne \back
    lds  r19, player + PLAYER_DONE + 2
    inc  r19
    sts  player + PLAYER_DONE + 2, r19
    rjmp \back
.endm

// The interval goes on along its ramp: r19:r18 in cycles, FAR_HIGH or more in r19 if it leaves what
// is usual. (`add` and the interval are below FAR_HIGH << 15 and << 16: so three bytes say it.)
.macro go_on_ramp
    ldd  r18, Y + BLOCK_INTERVAL
    ldd  r22, Y + BLOCK_ADD
    add  r18, r22
    std  Y + BLOCK_INTERVAL, r18
    ldd  r18, Y + BLOCK_INTERVAL + 1
    ldd  r22, Y + BLOCK_ADD + 1
    adc  r18, r22
    std  Y + BLOCK_INTERVAL + 1, r18
    ldd  r19, Y + BLOCK_INTERVAL + 2
    ldd  r22, Y + BLOCK_ADD + 2
    adc  r19, r22
    std  Y + BLOCK_INTERVAL + 2, r19
.endm

// The fourth byte, where the interval is no longer usual: it has become long, or less than nothing.
.macro complete_ramp
    ldi  r21, 0
    cpi  r19, 0xC0
    brlo 1f
    com  r21
1:  std  Y + BLOCK_INTERVAL + 3, r21
.endm

.macro double_share number
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_ADD
    lsl  r22
    std  Y + MINOR_SIZE * \number + MINOR_ADD, r22
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_ADD + 1
    rol  r22
    std  Y + MINOR_SIZE * \number + MINOR_ADD + 1, r22
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_ADD + 2
    rol  r22
    std  Y + MINOR_SIZE * \number + MINOR_ADD + 2, r22
.endm

.macro halve_share number
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_ADD + 2
    lsr  r22
    std  Y + MINOR_SIZE * \number + MINOR_ADD + 2, r22
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_ADD + 1
    ror  r22
    std  Y + MINOR_SIZE * \number + MINOR_ADD + 1, r22
    ldd  r22, Y + MINOR_SIZE * \number + MINOR_ADD
    ror  r22
    std  Y + MINOR_SIZE * \number + MINOR_ADD, r22
.endm

// End, interval, add and whether it is the last: all but its ramps.
.macro copy_piece
    .set copied, 0
    .rept PIECE_RAMPS
    ldd  r24, Z + copied
    std  Y + BLOCK_PIECE_END + copied, r24
    .set copied, copied + 1
    .endr
.endm

// player.cycles becomes player.last_cycles; both are below 1 << 16, as all that is usual.
.macro keep_last
    clr  r22
    sts  player + PLAYER_LAST + 2, r22
    sts  player + PLAYER_LAST + 3, r22
    lds  r22, player + PLAYER_CYCLES
    sts  player + PLAYER_LAST, r22
    lds  r22, player + PLAYER_CYCLES + 1
    sts  player + PLAYER_LAST + 1, r22
.endm

.global TIMER1_COMPA_vect
.type TIMER1_COMPA_vect, @function
TIMER1_COMPA_vect:
    movw r2, r24
    movw r4, r30
    movw r6, r18
    movw r8, r20
    movw r10, r22
    movw r12, r26
    movw r14, r28
    in   r24, _SFR_IO_ADDR(SREG)
    out  SAVED_SREG, r24

again:
    in   r25, MODE
    tst  r25
    breq phases
    sbrc r25, MODE_RISES
    rjmp rise
    sbrc r25, MODE_FALLS
    rjmp fall
    sbrc r25, MODE_CONTROLS
    rjmp control
    call_c player_play              // anything but a usual beat
    rjmp called

// ---- Phase card

phases:
    lds  r18, beat
    lds  r19, beat + 1
    lds  r20, beat + BEAT_END
    lds  r24, player + PLAYER_DUE
    lds  r25, player + PLAYER_DUE + 1
    wait_out
movements:
    movement 0
    breq written
    movement 1 r21
    breq written
    movement 2 r22
    breq written
    movement 3 r27
written:
    lds  r24, beat + BEAT_MIND
    eor  r23, r26
    or   r25, r23
    and  r25, r24
    breq examined
    eor  r21, r26
    sts  beat + BEAT_PINS, r21
    eor  r22, r26
    sts  beat + BEAT_PINS + 1, r22
    eor  r27, r26
    sts  beat + BEAT_PINS + 2, r27
    eor  r23, r26
    mov  r30, r20                   // the last one goes where the last movement is in its list
    subi r30, lo8(beat)
    lsr  r30
    subi r30, lo8(-(beat + BEAT_PINS - 1))
    ldi  r31, hi8(beat)
    st   Z, r23
    call_c inputs_examine_beat
examined:
    lds  r20, player + PLAYER_BEATS_LEFT
    sbic WANT, IS_LATE
    rjmp late
not_late:
    tst  r20
    breq tick_done
    lds  r24, player + PLAYER_MOVED
    lds  r25, beat + BEAT_MASK
    or   r24, r25
    sts  player + PLAYER_MOVED, r24
prepare_new:
    load_block
    rjmp prepare

done_higher:
    count_higher done_counted
perhaps_at_end:
    load_done 1
    cp   r18, r21
    brne within_piece
    load_done 2
    cp   r18, r21
    brne within_piece
    rjmp at_end
no_usual_tick:
    cpi  r25, RAMP_SLOW
    breq slow_tick
    in   r24, WANT
    tst  r24
    breq 1f
    rcall dry_is_ahead
    breq slow_tick
    tst  r25
    breq prepare
1:  rjmp ramp
slow_tick:
    call_c player_tick
    rjmp called

tick_done:
    sts  player + PLAYER_MOVED, r20
    load_block
    count_tick done_higher
done_counted:
    ldd  r21, Y + BLOCK_PIECE_END
    cp   r18, r21
    breq perhaps_at_end
within_piece:
    in   r24, WANT
    ldd  r25, Y + BLOCK_RAMPS
    ldd  r20, Y + BLOCK_BEATS
    or   r24, r25
    brne no_usual_tick

prepare:                            // r20: beats left
    ldi  r26, lo8(beat)
    ldi  r27, hi8(beat)
    ldi  r31, hi8(tracks)
    clr  r25
    ldd  r18, Y + BLOCK_BEAT_CYCLES
    ldd  r19, Y + BLOCK_BEAT_CYCLES + 1
this_beat:                          // r25 is 0: no motor has moved yet
    ldd  r21, Y + BLOCK_NARROW
    dec  r20
    brne minors
    ldd  r22, Y + BLOCK_LAG
    add  r18, r22
    adc  r19, r25
    move BLOCK_LEADER
minors:
    minor 0 2 none_narrow
    minor 1 2 minors_done
    minor 2 2 minors_done
minors_done:
    tst  r20
    breq prepared
    tst  r25
    brne prepared
    lds  r22, UCSR0A                // many empty beats take longer than two bytes
    sbrc r22, RXC0
    rjmp take_byte_early
next_beat:
    ldd  r22, Y + BLOCK_BEAT_CYCLES
    ldd  r23, Y + BLOCK_BEAT_CYCLES + 1
    add  r18, r22
    adc  r19, r23
    rjmp this_beat
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
    in   r24, SAVED_SREG
    out  _SFR_IO_ADDR(SREG), r24
    movw r28, r14
    movw r26, r12
    movw r22, r10
    movw r20, r8
    movw r18, r6
    movw r30, r4
    movw r24, r2
    reti

called:                             // r24: 0, the timer is stopped; 0xFF: it is set; or beats
    tst  r24
    breq restore
    mov  r20, r24
    cpi  r24, 0xFF
    breq 1f
    rjmp prepare_new
1:  lds  r24, OCR1AL
    lds  r25, OCR1AH
    rjmp poll

too_near:                           // the match may have passed: play on from here
    in   r24, MODE
    sbrc r24, MODE_FALLS
    rjmp 1f                         // as near to its edge as it likes
    lds  r24, player + PLAYER_PATIENCE
    dec  r24
    sts  player + PLAYER_PATIENCE, r24
    breq give_way
1:  sbi  _SFR_IO_ADDR(TIFR1), OCF1A
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

// Control lines change ahead of the movements.
control:
    lds  r20, beat + BEAT_CONTROL_HIGH
    in   r21, _SFR_IO_ADDR(PORT_HIGH)
    andi r21, DATA_HIGH_MASK
    or   r20, r21
    lds  r21, beat + BEAT_CONTROL_EXTRA
    lds  r24, player + PLAYER_DUE
    lds  r25, player + PLAYER_DUE + 1
    wait_out
    out  _SFR_IO_ADDR(PORT_HIGH), r20
    out  _SFR_IO_ADDR(PORT_EXTRA), r21
    ldi  r20, EARLY_CYCLES
    sts  player + PLAYER_EARLY, r20
    clr  r20
    sts  beat + BEAT_CONTROL_DUE, r20
    out  MODE, r20                  // MODE_PHASES
    lds  r18, beat
    lds  r19, beat + 1
    lds  r20, beat + BEAT_END
    rjmp movements

none_narrow:
    ldd  r21, Y + BLOCK_WIDE
    minor 0 3 minors_done
    minor 1 3 minors_done
    minor 2 3 minors_done
    rjmp minors_done
move_at_y:
    move 0
    ret

at_end:
    rcall go_over
    brne block_begins
    rcall next_piece
    brne piece_begins
    rjmp slow_tick
piece_begins:
    keep_last
    ldd  r18, Y + BLOCK_INTERVAL + 1
    ldd  r19, Y + BLOCK_INTERVAL + 2
    ldd  r20, Y + BLOCK_BEATS
    rjmp divide
block_begins:
    keep_last
    ldd  r22, Y + BLOCK_ENTRY
    sts  player + PLAYER_CYCLES, r22
    ldd  r22, Y + BLOCK_ENTRY + 1
    sts  player + PLAYER_CYCLES + 1, r22
    ldd  r24, Y + BLOCK_OUTPUTS_DUE
    tst  r24
    brne outputs_change
    ldd  r20, Y + BLOCK_BEATS
    rjmp prepare
outputs_change:
    call_c player_hand_over
    rjmp called

// What is wished (r24) is only a look at the dry point, and that is still ahead: else Z is set.
// Uses r18, r22.
dry_is_ahead:
    cpi  r24, 1 << MAY_RUN_DRY
    brne 3f
    lds  r18, throttle + THROTTLE_DRY_POINT
    tst  r18
    breq 1f
    lds  r18, player + PLAYER_SERIAL
    lds  r22, throttle + THROTTLE_DRY_SERIAL
    cp   r18, r22
    lds  r18, player + PLAYER_SERIAL + 1
    lds  r22, throttle + THROTTLE_DRY_SERIAL + 1
    cpc  r18, r22
    brmi 1f
    brne 3f
    lds  r18, player + PLAYER_DONE
    lds  r22, throttle + THROTTLE_DRY_TICK
    cp   r18, r22
    lds  r18, player + PLAYER_DONE + 1
    lds  r22, throttle + THROTTLE_DRY_TICK + 1
    cpc  r18, r22
    lds  r18, player + PLAYER_DONE + 2
    lds  r22, throttle + THROTTLE_DRY_TICK + 2
    cpc  r18, r22
    brsh 3f
    clz
    ret
1:  cbi  WANT, MAY_RUN_DRY          // it has moved on
    clz
    ret
3:  sez
    ret

// The next block in hand, at the end of the last piece of the one before; Z set: that is a matter
// for C. Uses r18, r24, r25.
go_over:
    in   r24, WANT
    lds  r18, player + PLAYER_IS_MINDED
    or   r24, r18
    brne 1f
    ldd  r18, Y + BLOCK_PIECE_IS_LAST
    lds  r25, player + PLAYER_NEXT + 1
    and  r18, r18
    breq 2f
    tst  r25                        // no address has the high byte 0
    breq 2f
    lds  r24, player + PLAYER_NEXT
    movw r28, r24
    sts  player + PLAYER_BLOCK, r28
    sts  player + PLAYER_BLOCK + 1, r29
    sts  player + PLAYER_LIMITS_OWED, r29
    ldd  r18, Y + BLOCK_SERIAL
    sts  player + PLAYER_SERIAL, r18
    ldd  r18, Y + BLOCK_SERIAL + 1
    sts  player + PLAYER_SERIAL + 1, r18
    lds  r18, player + PLAYER_TAKEN
    inc  r18
    sts  player + PLAYER_TAKEN, r18
    clr  r18
    sts  player + PLAYER_NEXT + 1, r18
    sts  player + PLAYER_DONE, r18
    sts  player + PLAYER_DONE + 1, r18
    sts  player + PLAYER_DONE + 2, r18
    sts  player + PLAYER_CHOSEN_AT, r18
    sts  player + PLAYER_CHOSEN_AT + 1, r18
    sts  player + PLAYER_CHOSEN_AT + 2, r18
    tst  r29
    ret
1:  sez
2:  ret

// The next piece of the block in hand, likewise. Uses r18, r24, r25, Z.
next_piece:
    in   r24, WANT
    ldd  r18, Y + BLOCK_PIECE_IS_LAST
    or   r24, r18
    brne 1b
    lds  r18, piece_tail
    lds  r24, piece_head
    cp   r18, r24
    breq 2b
    mov  r30, r18                   // 14 times: PIECE_SIZE
    lsl  r30
    mov  r31, r30
    lsl  r30
    lsl  r30
    lsl  r30
    sub  r30, r31
    clr  r31
    subi r30, lo8(-(pieces))
    sbci r31, hi8(-(pieces))
    ldd  r25, Z + PIECE_RAMPS
    bst  r25, RAMP_TURNS
    andi r25, ~(1 << RAMP_TURNS) & 0xFF
    cpi  r25, RAMP_SLOW
    breq 2b
    std  Y + BLOCK_RAMPS, r25
    copy_piece
    brtc 4f
    ldd  r24, Z + PIECE_IS_RAMP     // the throttle is open: BOOST is what the pieces say
    std  Y + BLOCK_IS_RAMP, r24
    lds  r24, card + CARD_CONTROL
    lds  r25, card + CARD_BOOST
    eor  r24, r25
    sts  card + CARD_CONTROL, r24
    lds  r25, card + CARD_BOOST_HIGH
    lds  r24, card + CARD_CONTROL_HIGH
    eor  r24, r25
    sts  card + CARD_CONTROL_HIGH, r24
    lds  r24, beat + BEAT_REST + 1
    eor  r24, r25
    sts  beat + BEAT_REST + 1, r24
    in   r24, _SFR_IO_ADDR(PORT_HIGH)
    eor  r24, r25
    out  _SFR_IO_ADDR(PORT_HIGH), r24
4:
    inc  r18
    andi r18, PIECES - 1
    sts  piece_tail, r18
    lds  r24, player + PLAYER_DONE
    sts  player + PLAYER_CHOSEN_AT, r24
    lds  r24, player + PLAYER_DONE + 1
    sts  player + PLAYER_CHOSEN_AT + 1, r24
    lds  r24, player + PLAYER_DONE + 2
    sts  player + PLAYER_CHOSEN_AT + 2, r24
    clz
    ret

// The tick is chosen, but its interval is none for beats.S.
ramp_ends:
    complete_ramp
    call_c player_tick_chosen
    rjmp called

// The interval changes from tick to tick; its number of beats seldom does.
ramp:
    go_on_ramp
    cpi  r19, FAR_HIGH
    brsh ramp_ends
divide:
    sts  player + PLAYER_CYCLES, r18
    sts  player + PLAYER_CYCLES + 1, r19
    movw r22, r18
    ldi  r21, 1
    ldd  r24, Y + BLOCK_SHORTEST
    ldd  r25, Y + BLOCK_SHORTEST + 1
1:  cpi  r21, 8
    breq 2f
    cp   r22, r24
    cpc  r23, r25
    brlo 2f
    lsr  r23
    ror  r22
    lsl  r21
    rjmp 1b
2:  std  Y + BLOCK_BEAT_CYCLES, r22
    std  Y + BLOCK_BEAT_CYCLES + 1, r23
    cp   r20, r21
    brne beats_change
beats_known:
    dec  r21
    and  r21, r18
    std  Y + BLOCK_LAG, r21
    rjmp prepare

// From r20 beats to r21: the minors' shares in a beat double or halve.
beats_change:
    std  Y + BLOCK_BEATS, r21
    brlo 4f
3:  double_share 0
    double_share 1
    double_share 2
    lsr  r20
    cp   r20, r21
    brne 3b
    rjmp beats_known
4:  halve_share 0
    halve_share 1
    halve_share 2
    lsl  r20
    cp   r20, r21
    brne 4b
    rjmp beats_known

// A write came late: from a quarter of the interval on it is counted, and all that follows moves
// (player.c: note_late).
late:
    cbi  WANT, IS_LATE
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

// ---- Clock lines: a pause, the edge, a pulse, the fall; then the next interval is chosen.

// r18, r19: two port bytes, at their cycle.
.macro write_pair_at_due
    lds  r24, player + PLAYER_DUE
    lds  r25, player + PLAYER_DUE + 1
    wait_out
    out  _SFR_IO_ADDR(PORT_LOW), r18
    out  _SFR_IO_ADDR(PORT_HIGH), r19
.endm

// The next deadline is r19:r18 after this one, its mode r20.
set_timer:
    out  MODE, r20
    rjmp prepared_wait

rise:
    lds  r18, beat
    lds  r19, beat + 1
    write_pair_at_due
    in   r23, _SFR_IO_ADDR(PIN_STATUS)
    lds  r24, beat + BEAT_QUIET
    eor  r24, r23
    lds  r25, beat + BEAT_RESTLESS
    or   r24, r25
    lds  r25, beat + BEAT_MIND
    and  r24, r25
    breq 1f
    sts  beat + BEAT_PINS, r23
    call_c inputs_examine_beat
1:  sbic WANT, IS_LATE
    rjmp late_rise
rise_counted:
    load_block
    count_tick rise_higher
rise_done_counted:
    ldd  r21, Y + BLOCK_PIECE_END
    cp   r18, r21
    breq rise_perhaps_last
rise_within_piece:
    ldd  r25, Y + BLOCK_RAMPS
    cpi  r25, RAMP_STEADY
    brne rise_unsteady
    lds  r18, player + PLAYER_FALL
    lds  r19, player + PLAYER_FALL + 1
    ldi  r20, MODE_STEADY_FALL
    rjmp make_out

rise_higher:
    count_higher rise_done_counted
rise_perhaps_last:                  // if so, the next block is seen to now, the next edge after the fall
    load_done 1
    cp   r18, r21
    brne rise_within_piece
    load_done 2
    cp   r18, r21
    brne rise_within_piece
    rcall find_fall
    rcall go_over
    ldi  r20, MODE_LAST_FALL
    breq 1f
    ldi  r20, MODE_NEXT_FALL
1:  lds  r18, player + PLAYER_FALL
    rjmp set_timer
rise_unsteady:
    rcall find_fall
    ldi  r20, MODE_FAST_FALL
    rjmp make_out

// From the edge to the fall, in r19:r18; a ramp goes on.
find_fall:
    ldd  r25, Y + BLOCK_RAMPS
    cpi  r25, RAMP_FAST
    brne 2f
    go_on_ramp
    cpi  r19, FAR_HIGH
    brlo 2f
    complete_ramp
2:  lds  r18, player + PLAYER_FALL
    lds  r19, player + PLAYER_FALL + 1
    ret

// Up to a quarter of its interval a write may be late without more ado (of a fall's, an eighth of the
// whole), unless pulses must be so long that one could be cut short by it.
.macro excuse shifts back
    lds  r22, player + PLAYER_LATE
    lds  r23, player + PLAYER_LATE + 1
    lds  r24, player + PLAYER_CYCLES
    lds  r25, player + PLAYER_CYCLES + 1
.rept \shifts
    lsr  r25
    ror  r24
.endr
    cbi  WANT, IS_LATE
    cp   r24, r22
    cpc  r25, r23
    brlo 1f
    lds  r22, card + CARD_PULSE + 1
    tst  r22
    brne 1f
    sbis WANT, IS_THROTTLED
    rjmp \back
1:  call_c player_clocks_late
    rjmp \back
.endm
late_rise:
    excuse 2 rise_counted
late_fall:
    excuse 3 fallen

fall:
    lds  r18, beat + BEAT_REST
    lds  r19, beat + BEAT_REST + 1
    write_pair_at_due
    sbic WANT, IS_LATE
    rjmp late_fall
fallen:
    in   r24, WANT
    in   r20, MODE
    tst  r24
    brne fall_wished
fall_unwished:
    cpi  r20, MODE_STEADY_FALL
    brne fall_unsteady
    lds  r18, player + PLAYER_WAIT
    lds  r19, player + PLAYER_WAIT + 1
to_rise:
    ldi  r20, MODE_FAST_RISE
    rjmp set_timer

fall_wished:
    cpi  r20, MODE_LAST_FALL
    brsh slow_fall
    cpi  r24, 1 << IS_THROTTLED
    brne 2f
    rjmp fall_throttled
2:  rcall dry_is_ahead
    brne fall_unwished
slow_fall:                          // r20: the mode says whether the next edge is made out
    ldi  r24, 1
    cpi  r20, MODE_LAST_FALL
    brlo 1f
    ldi  r24, 0
1:  sts  player + PLAYER_IS_MADE_OUT, r24
    call_c player_fell
    rjmp called

fall_unsteady:
    load_block
    cpi  r20, MODE_LAST_FALL
    brne 1f
    rcall go_over
    brne 1f
    rcall next_piece
    breq slow_fall
1:  ldd  r25, Y + BLOCK_RAMPS
    cpi  r25, RAMP_SLOW
    breq slow_fall
    lds  r18, player + PLAYER_WAIT
    lds  r19, player + PLAYER_WAIT + 1
    cpi  r25, RAMP_STEADY
    breq wait_known
    ldd  r18, Y + BLOCK_INTERVAL + 1
    ldd  r19, Y + BLOCK_INTERVAL + 2
    cpi  r19, FAR_HIGH
    brsh slow_fall
    lds  r22, card + CARD_PULSE     // no pulse and no pause is shorter
    lds  r23, card + CARD_PULSE + 1
    lsl  r22
    rol  r23
    cp   r18, r22
    cpc  r19, r23
    brsh 1f
    movw r18, r22
1:  keep_last
    sts  player + PLAYER_CYCLES, r18
    sts  player + PLAYER_CYCLES + 1, r19
halve:
    movw r22, r18
    lsr  r23
    ror  r22
    sts  player + PLAYER_FALL, r22
    sts  player + PLAYER_FALL + 1, r23
    sub  r18, r22
    sbc  r19, r23
    cpi  r25, RAMP_FAST
    breq wait_known
    sts  player + PLAYER_WAIT, r18
    sts  player + PLAYER_WAIT + 1, r19
    ldi  r24, RAMP_STEADY
    std  Y + BLOCK_RAMPS, r24
wait_known:
    cpi  r20, MODE_LAST_FALL
    brsh 1f
    rjmp to_rise
1:  ldi  r20, MODE_FAST_RISE

// The motors of the next edge, into beat; then the timer is set. Keeps r18 to r20.
make_out:
    ldd  r26, Y + BLOCK_LEADER      // bits of the data byte
    ldd  r21, Y + BLOCK_NARROW
.macro clock_minor number bytes done
    dec  r21
    brpl 1f
    rjmp \done
1:  load_sum \number \bytes
    brcc 2f
    take_off_limit \bytes
    ldd  r30, Y + MINOR_SIZE * \number + MINOR_MOVER
    or   r26, r30
2:  store_sum \number \bytes
.endm
    clock_minor 0 2 clocks_none_narrow
    clock_minor 1 2 clocks_done
    clock_minor 2 2 clocks_done
clocks_done:
    sts  beat + BEAT_MASK, r26
    lds  r23, card + CARD_DATA
    eor  r26, r23
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
    rjmp set_timer

// Between two moves of the throttle the next tick takes what this one took: throttle_goes_on.
3:  rjmp slow_fall
fall_throttled:
    load_block
    ldd  r25, Y + BLOCK_RAMPS
    cpi  r25, RAMP_SLOW
    breq 3b
    ldi  r30, lo8(throttle)
    ldi  r31, hi8(throttle)
    ldd  r24, Z + THROTTLE_IS_STEADY
    tst  r24
    breq 3b
    lds  r18, player + PLAYER_CYCLES
    lds  r19, player + PLAYER_CYCLES + 1
    ldd  r22, Y + BLOCK_INTERVAL + 1
    ldd  r23, Y + BLOCK_INTERVAL + 2
    cp   r18, r22                   // the plan is slower
    cpc  r19, r23
    brlo 3b
    ldd  r22, Z + THROTTLE_ELAPSED
    ldd  r23, Z + THROTTLE_ELAPSED + 1
    add  r22, r18
    adc  r23, r19
    brcs 3b
    ldd  r24, Z + THROTTLE_STEADY_UNTIL
    ldd  r25, Z + THROTTLE_STEADY_UNTIL + 1
    cp   r22, r24
    cpc  r23, r25
    brlo 1f
    ldd  r24, Z + THROTTLE_MARK
    ldd  r25, Z + THROTTLE_MARK + 1
    or   r24, r25
    ldd  r25, Z + THROTTLE_RATE_OWED
    or   r24, r25
    brne 3b
    std  Z + THROTTLE_MARK, r22
    std  Z + THROTTLE_MARK + 1, r23
    movw r24, r22
    subi r24, lo8(-(THROTTLE_AHEAD))
    sbci r25, hi8(-(THROTTLE_AHEAD))
    std  Z + THROTTLE_STEADY_UNTIL, r24
    std  Z + THROTTLE_STEADY_UNTIL + 1, r25
    ldd  r24, Z + THROTTLE_TURN
    inc  r24
    std  Z + THROTTLE_TURN, r24
1:  std  Z + THROTTLE_ELAPSED, r22
    std  Z + THROTTLE_ELAPSED + 1, r23
    ldi  r25, RAMP_FAST             // the plan is no matter
    rjmp halve

clocks_none_narrow:
    ldd  r21, Y + BLOCK_WIDE
    clock_minor 0 3 clocks_done
    clock_minor 1 3 clocks_done
    clock_minor 2 3 clocks_done
    rjmp clocks_done

.size TIMER1_COMPA_vect, . - TIMER1_COMPA_vect
