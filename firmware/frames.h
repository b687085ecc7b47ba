/* Frames: bytes to commands and back. docs/bridge-protocol.md, sections 1 and 2.
 *
 *   FLAG | kind | sequence | payload ... | crc high | crc low | FLAG      (stuffed between FLAGs)
 *
 * Rule 1: nothing of a frame is believed before its CRC is.
 * Rule 2: an urgent counts between frames, or doubled; alone inside a frame it is damage.
 */
#ifndef FRAMES_H
#define FRAMES_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol.h"

#define CONTENT_MAX (2 + PAYLOAD_MAX + 2)
#define REPORT_MAX 60

/* Take what has come over the line, at most one frame. */
void frames_receive(void);
/* Send on, a byte at a time. */
void frames_send(void);
bool frames_may_begin(void);
/* Begin a frame: its payload is written to the buffer returned, then frames_close(length). */
uint8_t *frames_open(uint8_t kind);
void frames_close(uint8_t payload_length);

#endif
