/* Commands of the host, and the answers.
 *
 * Rule 1: a command is carried out when its sequence number is the awaited one, else never.
 * Rule 2: every kind is a row of a table: payload length, what must be true, what is done.
 * Rule 3: reports are made when asked for, or when something happened that the host should know at
 *         once; each is a picture of one moment.
 */
#ifndef COMMANDS_H
#define COMMANDS_H

#include <stdbool.h>
#include <stdint.h>

void commands_begin(uint8_t reset_reason, uint16_t boots);
/* A frame with a good CRC: kind, sequence, payload. */
void command_take(const uint8_t *content, uint8_t payload_length);
void command_urgent(uint8_t byte);
/* Begin a report if one is due. */
void reports_service(void);

#endif
