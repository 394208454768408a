#include "emit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "manifest.h"

enum { SLURM, PARALLEL, NUM_ENGINES };
static const char *const engines[NUM_ENGINES] = {"slurm", "parallel"};

static int engine_of(const char *name)
{
  int k = 0;
  while (k < NUM_ENGINES && strcmp(name, engines[k]) != 0) k++;
  return k;
}

status emit_check(const char *engine)
{
  return engine_of(engine) < NUM_ENGINES
           ? OK
           : user_error("--emit: '%s' found, allowed is slurm or parallel, then a folder", engine);
}

/* As one word of the shell. */
static void put_word(FILE *out, const char *text)
{
  fputc('\'', out);
  for (const char *c = text; *c; c++)
    if (*c == '\'')
      fputs("'\\''", out);
    else
      fputc(*c, out);
  fputc('\'', out);
}

struct job {
  const struct emit *emit;
  const struct queue *queue;
  struct path folder, program, manifest; /* from the root on */
  int tasks;
  long most; /* runs in the largest task */
};

static void put_worker(FILE *out, const struct job *job)
{
  put_word(out, job->program.text);
  fputs(" sweep --manifest ", out);
  put_word(out, job->manifest.text);
}

/* The whole minutes that the largest task may take at worst; a run that does not stop at its limit
 * is killed within the limit again. */
static long minutes(const struct job *job)
{
  return (long)ceil(2 * job->queue->limit * (double)job->most / 60) + 1;
}

static void put_slurm(FILE *out, const struct job *job)
{
  const long own_memory = 256; /* MiB, of the task itself and of libraries */
  fprintf(out, "#!/bin/bash\n#SBATCH --job-name=sphbench\n#SBATCH --array=0-%d", job->tasks - 1);
  if (job->emit->jobs > 0) fprintf(out, "%%%ld", job->emit->jobs);
  fputs("\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\n", out);
  if (job->queue->memory > 0) fprintf(out, "#SBATCH --mem=%ldM\n", job->queue->memory + own_memory);
  if (job->queue->limit > 0) fprintf(out, "#SBATCH --time=%ld\n", minutes(job));
  fprintf(out, "#SBATCH --output=\"%s/task-%%a.log\"\n", job->folder.text);
  fputs("#SBATCH --open-mode=append\n#SBATCH --requeue\n"
        "# A task that is started again goes on where it was. Runs have one thread each.\n"
        "exec ",
        out);
  put_worker(out, job);
  fputs(" --task \"$SLURM_ARRAY_TASK_ID\" --quiet\n", out);
}

static void put_parallel(FILE *out, const struct job *job)
{
  fputs("#!/bin/bash\n"
        "# Further arguments are parallel's own, e.g. --sshloginfile FILE, --eta.\n"
        "# What is finished is not run again, so the script may be started again.\n"
        "exec parallel --halt never --joblog ",
        out);
  const struct path log = path_of("%s/joblog", job->folder.text);
  put_word(out, log.text);
  if (job->emit->jobs > 0) fprintf(out, " --jobs %ld", job->emit->jobs);
  fputs(" \"$@\" ", out);
  /* parallel puts the number where {} stands, and reads the rest as the shell does */
  FILE *text;
  char *words = NULL;
  size_t size;
  if (!(text = open_memstream(&words, &size))) return;
  put_worker(text, job);
  fclose(text);
  put_word(out, words);
  free(words);
  fprintf(out, " --task {} --quiet ::: {0..%d}\n", job->tasks - 1);
}

static status write_script(const struct job *job, const char *path)
{
  struct new_file file;
  TRY(file_begin(&file, path));
  if (engine_of(job->emit->engine) == SLURM)
    put_slurm(file.stream, job);
  else
    put_parallel(file.stream, job);
  TRY(file_commit(&file));
  return chmod(path, 0755) ? status_set(ERR_IO, "cannot make '%s' executable", path) : OK;
}

static status locate(struct job *job)
{
  char *folder = realpath(job->emit->folder, NULL);
  const ssize_t n = readlink("/proc/self/exe", job->program.text, sizeof job->program.text - 1);
  if (folder) job->folder = path_of("%s", folder);
  job->manifest = path_of("%s/manifest.json", job->folder.text);
  if (n > 0) job->program.text[n] = '\0';
  const int found = folder && n > 0;
  free(folder);
  return found ? OK : status_set(ERR_IO, "cannot find '%s' again", job->emit->folder);
}

static long largest(const int *task, int n)
{
  long most = 0, held = 0;
  for (int k = 0, at = -1; k < n; k++) {
    if (task[k] < 0) continue;
    held = task[k] == at ? held + 1 : 1;
    at = task[k];
    if (held > most) most = held;
  }
  return most;
}

static void tell(const struct job *job, const char *script)
{
  const int slurm = engine_of(job->emit->engine) == SLURM;
  int todo = 0;
  for (int k = 0; k < job->queue->n; k++) todo += !job->queue->run[k].finished;
  printf("%d runs in %d tasks, at most %ld in one\n"
         "start them:  %s%s\n"
         "then gather: sphbench sweep %s --results %s\n",
         todo, job->tasks, job->most, slurm ? "sbatch " : "", script, job->emit->plan,
         job->queue->results);
}

static status write_all(struct job *job, int *task)
{
  const struct path script = path_of("%s/job.sh", job->emit->folder);
  job->tasks = manifest_deal(job->queue, job->emit->batch, task);
  job->most = largest(task, job->queue->n);
  if (job->tasks == 0)
    return user_error("--emit: all %d runs are finished, there is nothing to emit; --fresh runs "
                      "them again",
                      job->queue->n);
  TRY(folder_make(job->emit->folder));
  TRY(locate(job));
  const struct manifest_settings settings = {job->manifest.text, job->emit->plan, task, job->tasks,
                                             job->emit->fresh};
  TRY(manifest_write(&settings, job->queue));
  TRY(write_script(job, script.text));
  if (!job->queue->quiet) tell(job, script.text);
  return OK;
}

status emit_write(const struct emit *emit, const struct queue *queue)
{
  struct job job = {.emit = emit, .queue = queue};
  int *task = calloc((size_t)queue->n + 1, sizeof *task);
  if (!task) return status_set(ERR_MEMORY, "out of memory");
  const status result = write_all(&job, task);
  free(task);
  return result;
}
