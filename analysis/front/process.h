/* process.h - starting other programs. Children end when this process does, even if it is killed.
 */
#ifndef PROCESS_H
#define PROCESS_H
#include <sys/types.h>
#include "../../core/base/status.h"

struct process {
  const char *const *argv; /* NULL-terminated; argv[0] is looked up in PATH unless it has a '/' */
  const char *folder;      /* to run in; NULL: here */
  const char *log;         /* both outputs go to this file; NULL: they stay */
  int output;              /* standard output goes to this descriptor; 0: to the log */
  int one_thread;          /* OMP_NUM_THREADS=1, not bound to a core */
  const int *cores;        /* processors [num_cores] that it stays on, a thread on each */
  int num_cores;           /* 0: any */
  long most_memory;        /* [MiB] of data that it may hold; 0: any */
};

/* ERR_IO: it cannot be started. */
status process_start(const struct process *process, pid_t *child);

/* Run to its end; *exit_code is 128 + signal for one that was killed, 127 if it was not found. */
status process_wait(const struct process *process, int *exit_code);

/* The standard output of a program that ends with 0, NULL otherwise; to be released by free(). Its
 * messages are dropped. */
char *process_output(const char *const *argv);

#endif
