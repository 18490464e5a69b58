#include "must.h"

#include <stdio.h>
#include <stdlib.h>

long frame_number;

static void fail(const char *what)
{
    fprintf(stderr, "frame %ld: %s\n", frame_number, what);
    abort();
}

void must(bool holds, const char *what)
{
    if (!holds) {
        fail(what);
    }
}
