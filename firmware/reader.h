/* The ring of records, and what is made of them for the player.
 *
 *   BLOCKS frame -> arrival: length, dry point taken off -> ring -> one block and its pieces ahead
 *
 * Rule 1: bytes of a record are stored as they come; it counts as arrived with its last one.
 * Rule 2: everything that a block needs and that takes time (leader, directions, start/stop
 *         interval, ratios of a junction) is worked out here, before the player takes it.
 * Rule 3: decoding goes in steps of one head or one piece, so that the line is polled in between.
 */
#ifndef READER_H
#define READER_H

#include "state.h"

/* Bytes that the ring takes. */
uint16_t reader_free(void);
bool reader_has_bytes(void);
/* What the player waits for is there. */
bool reader_has_ready(void);
/* Bytes of the stream, for which there is room. */
void reader_take(const uint8_t *bytes, uint8_t count);
void reader_drop(void);
/* Serials begin anew. */
void reader_forget(void);
uint16_t reader_last_serial(void);
/* One step ahead; true: something was done. */
bool reader_service(void);

#endif
