/* result_json.h - the object that `run --json FILE` writes (docs: command line). */
#ifndef RESULT_JSON_H
#define RESULT_JSON_H
#include "../base/status.h"
#include "run_facts.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Write the facts to `path`, under its name only when whole; "-" is standard output; a device or
 * pipe is written to directly. Numbers that are not finite become null. ERR_IO with a sentence,
 * ERR_MEMORY. */
status result_json_write(const char *path, const struct run_facts *facts);

#ifdef __cplusplus
}
#endif
#endif
