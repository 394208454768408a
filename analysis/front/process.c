#include "process.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NOT_FOUND = 127 }; /* as in the shell */

static void stay_on(const int *cores, int n)
{
  cpu_set_t set;
  CPU_ZERO(&set);
  for (int k = 0; k < n; k++) CPU_SET(cores[k], &set);
  if (n > 0 && sched_setaffinity(0, sizeof set, &set) == 0) setenv("OMP_PROC_BIND", "true", 1);
}

/* Ends with its parent, at once: what lived on for a while could write over the results of the one
 * that is started in its place. */
static void become(const struct process *p, pid_t parent)
{
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) return; /* it was killed before that */
  const int log = open(p->log ? p->log : "/dev/null", O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (p->log || p->output > 0) dup2(log, STDERR_FILENO);
  if (p->output > 0)
    dup2(p->output, STDOUT_FILENO);
  else if (p->log)
    dup2(log, STDOUT_FILENO);
  if (log > STDERR_FILENO) close(log);
  if (p->output > STDERR_FILENO) close(p->output);
  if (p->one_thread) {
    setenv("OMP_NUM_THREADS", "1", 1);
    setenv("OMP_PROC_BIND", "false", 1); /* or all children would sit on the first core */
  }
  setenv("OMP_WAIT_POLICY", "passive", 0); /* spinning threads starve those of other runs */
  stay_on(p->cores, p->num_cores);
  if (p->most_memory > 0) { /* of data, not of addresses, of which a GPU's driver takes many */
    const rlim_t most = (rlim_t)p->most_memory << 20;
    setrlimit(RLIMIT_DATA, &(struct rlimit){most, most});
  }
  if (p->folder && chdir(p->folder)) return;
  execvp(p->argv[0], (char *const *)p->argv);
}

status process_start(const struct process *process, pid_t *child)
{
  const pid_t parent = getpid();
  fflush(NULL);
  *child = fork();
  if (*child < 0)
    return status_set(ERR_IO, "cannot start '%s': %s", process->argv[0], strerror(errno));
  if (*child == 0) {
    become(process, parent);
    fprintf(stderr, "cannot start '%s': %s\n", process->argv[0], strerror(errno));
    _exit(NOT_FOUND); /* the child's way out: returning would run the parent's code twice */
  }
  return OK;
}

static int exit_code_of(int state)
{
  return WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
}

static int wait_for(pid_t child)
{
  int state = 0;
  while (waitpid(child, &state, 0) < 0 && errno == EINTR) continue;
  return exit_code_of(state);
}

status process_wait(const struct process *process, int *exit_code)
{
  pid_t child;
  TRY(process_start(process, &child));
  *exit_code = wait_for(child);
  return OK;
}

static char *read_all(int from)
{
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  char part[4096];
  ssize_t got;
  while ((got = read(from, part, sizeof part)) > 0 || (got < 0 && errno == EINTR))
    if (got > 0 && out) fwrite(part, 1, (size_t)got, out);
  if (out) fclose(out);
  return text;
}

char *process_output(const char *const *argv)
{
  int ends[2];
  pid_t child;
  if (pipe2(ends, O_CLOEXEC)) return NULL;
  const struct process process = {.argv = argv, .output = ends[1]};
  const status started = process_start(&process, &child);
  close(ends[1]);
  char *text = started == OK ? read_all(ends[0]) : NULL;
  close(ends[0]);
  if (started == OK && wait_for(child) == 0) return text;
  free(text);
  return NULL;
}
