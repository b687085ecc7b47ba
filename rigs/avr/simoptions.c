#include "simoptions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int complain(const char *problem, const char *word) {
    fprintf(stderr, "simhost: %s%s\n", problem, word);
    return -1;
}

int options_parse(options_t *options, int count, char **words) {
    const struct {
        const char *name;
        const char **text;
        double *number;
        int *integer, *flag;
    } table[] = {
        {.name = "--link", .text = &options->link},
        {.name = "--log", .text = &options->log},
        {.name = "--shared", .text = &options->shared},
        {.name = "--speed", .number = &options->speed},
        {.name = "--unplug-after", .number = &options->unplug_after_s},
        {.name = "--seconds", .number = &options->seconds},
        {.name = "--stall-ms", .integer = &options->stall_ms},
        {.name = "--boot-ms", .integer = &options->boot_ms},
        {.name = "--mark", .integer = &options->mark},
        {.name = "--keep-running", .flag = &options->keep_running},
        {.name = "--any-baud", .flag = &options->any_baud},
    };
    for (int i = 1; i < count; i++) {
        size_t row = 0;
        while (row < sizeof table / sizeof *table && strcmp(words[i], table[row].name))
            row++;
        if (row == sizeof table / sizeof *table) {
            if (words[i][0] == '-' || options->image)
                return complain("unknown option ", words[i]);
            options->image = words[i];
        } else if (table[row].flag) {
            *table[row].flag = 1;
        } else if (++i == count) {
            return complain("a value is missing after ", table[row].name);
        } else if (table[row].text) {
            *table[row].text = words[i];
        } else if (table[row].number) {
            *table[row].number = atof(words[i]);
        } else {
            *table[row].integer = atoi(words[i]);
        }
    }
    if (!options->image || !options->link)
        return complain("needs an image and ", "--link");
    return 0;
}
