/* status.h - the three kinds of error. The user's mistake and a failing system are a `status` with
 * one sentence; the programmer's is an assert; a run that diverges is a result and no error at all.
 */
#ifndef STATUS_H
#define STATUS_H
#ifdef __cplusplus
extern "C" {
#endif

#define STATUS_LIST(S)                                             \
  S(OK, 0, "success")                                              \
  S(ERR_USER, 2, "the request cannot be carried out as it stands") \
  S(ERR_MEMORY, 3, "out of memory")                                \
  S(ERR_IO, 2, "a file could not be read or written")              \
  S(ERR_RUN, 3, "the run failed")                                  \
  S(ERR_WORSE, 1, "a comparison with a baseline failed")           \
  S(ERR_SKIPPED, 77, "skipped")

#define S(code, exit_code, text) code,
typedef enum { STATUS_LIST(S) NUM_STATUS } status;
#undef S

/* Record the sentence that the user will read and return `code`. printf-style; no newline, no
 * trailing period. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
status
status_set(status code, const char *format, ...);

#define user_error(...) status_set(ERR_USER, __VA_ARGS__)

/* The last recorded sentence; "" when there is none. Valid until the next status_set. */
const char *status_sentence(void);

/* The process exit code that belongs to a status (docs: command line). */
int status_exit_code(status code);

/* The name in `names` (n entries) that is nearest to `wanted` by edit distance; NULL if none is
 * near. */
const char *nearest_name(const char *wanted, const char *const *names, int n);

#define TRY(call)                \
  do {                           \
    const status try_ = (call);  \
    if (try_ != OK) return try_; \
  } while (0)

#ifdef __cplusplus
}
#endif
#endif
