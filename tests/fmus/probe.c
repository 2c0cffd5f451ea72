// SPDX-License-Identifier: Apache-2.0
// A small FMU that uses no code of MEbots. A test can check its values by hand. It commits faults on request.
//
//   real_out = gain * real_in + offset     (direct, also in initialisation mode)
//   integral += h * real_in                (forward Euler with the step's held input)
//   integer_out = integer_in + 1, boolean_out = !boolean_in, string_out = string_in + "!"  (direct)
//   steps is the number of steps; last_end and last_step are t + h and h of the last step
//   set_backs is the number of steps with noSetFMUStatePriorToCurrentPoint = false, after which the importer may set an
//   earlier state
//   fault is the name of the fault that occurs in the step that reaches fault_time
// With PROBE_STEADY, its only faults are "slow" and "error", and it imports no function that changes the process
// (steady.fmu). Like some FMUs, it lacks the functions of capabilities that it does not declare.
#define _GNU_SOURCE
#include "fmi2.h"

#include "frame.h"

#include <errno.h>
#include <fcntl.h>
#include <fenv.h>
#include <math.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifndef GUID
#define GUID "{probe}"
#endif

enum { REAL_IN, GAIN, OFFSET, FAULT_TIME, REAL_OUT, INTEGRAL, LAST_END, LAST_STEP, REALS };
enum {
  INTEGER_IN,
  MODE_IN,
  INTEGER_OUT,
  MODE_OUT,
  STEPS,
  BUFFER_LO,
  BUFFER_HI,
  BUFFER_SIZE,
  TAKEN_LO,
  TAKEN_HI,
  TAKEN_SIZE,
  TAKEN_SUM,
  SET_BACKS,
  INTEGERS
};
enum { BOOLEAN_IN, BOOLEAN_OUT, BOOLEANS };
enum { STRING_IN, FAULT, STRING_OUT, RESOURCES, STRINGS };
enum { TEXT_SIZE = 512 };

typedef struct {
  double reals[REALS];
  int integers[INTEGERS];
  int booleans[BOOLEANS];
  char strings[STRINGS][TEXT_SIZE];
  unsigned char buffers[2][16];
  int buffer;
  int terminated;
  double time;
} State;

typedef struct {
  State state;
  fmi2CallbackFunctions callbacks;
  char name[TEXT_SIZE];
  int zero;  // a zero that the compiler cannot see
  int* null;
  int file;
  int has_thread;
  int was_bad;     // true if a fault that occurs only once has occurred
  int bad_string;  // true if string_out is at an invalid address
} Probe;

/// Throws C++ exceptions; defined in probe_throw.cpp.
void probe_throw(const char* kind);

static void say(Probe* p, fmi2Status status, const char* category, const char* text, double value) {
  p->callbacks.logger(p->callbacks.componentEnvironment, p->name, status, category, "%s (%g)", text, value);
}

static void compute(Probe* p) {
  State* s = &p->state;
  s->reals[REAL_OUT] = s->reals[GAIN] * s->reals[REAL_IN] + s->reals[OFFSET];
  s->integers[INTEGER_OUT] = s->integers[INTEGER_IN] + 1;
  s->integers[MODE_OUT] = s->integers[MODE_IN];
  s->booleans[BOOLEAN_OUT] = !s->booleans[BOOLEAN_IN];
  strncpy(s->strings[STRING_OUT], s->strings[STRING_IN], TEXT_SIZE - 2);
  strcat(s->strings[STRING_OUT], "!");
}

static void show_buffer(Probe* p) {
  State* s = &p->state;
  const unsigned long address = (unsigned long)s->buffers[s->buffer];
  s->integers[BUFFER_LO] = (int)(unsigned int)address;
  s->integers[BUFFER_HI] = (int)(unsigned int)(address >> 32);
  s->integers[BUFFER_SIZE] = (int)sizeof s->buffers[0];
}

static void fill_buffer(Probe* p) {
  State* s = &p->state;
  s->buffer = !s->buffer;
  memset(s->buffers[s->buffer], s->integers[STEPS] % 256, sizeof s->buffers[0]);
  show_buffer(p);
}

static void take_buffer(Probe* p) {
  State* s = &p->state;
  const unsigned long address =
      ((unsigned long)(unsigned int)s->integers[TAKEN_HI] << 32) | (unsigned int)s->integers[TAKEN_LO];
  s->integers[TAKEN_SUM] = 0;
  for (int i = 0; address != 0 && i < s->integers[TAKEN_SIZE]; ++i) {
    s->integers[TAKEN_SUM] += ((const unsigned char*)address)[i];
  }
}

FMI2_VERSIONS

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)visible;
  if (type != fmi2CoSimulation || strcmp(guid, GUID) != 0) {
    if (logging)
      callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "the GUID is %s, not %s",
                        guid, GUID);
    return NULL;
  }
  Probe* p = callbacks->allocateMemory(1, sizeof *p);
  p->callbacks = *callbacks;
  strncpy(p->name, name, TEXT_SIZE - 1);
  p->state.reals[GAIN] = 1;
  p->state.reals[FAULT_TIME] = 1;
  strncpy(p->state.strings[RESOURCES], resources, TEXT_SIZE - 1);
  return p;
}

/// Changes settings that affect the whole process.
static void meddle(void) {
  umask(0);
  if (chdir("/") != 0) abort();
  const struct rlimit no_core = {0, 1 << 20};
  setrlimit(RLIMIT_CORE, &no_core);
  signal(SIGUSR1, SIG_IGN);
  close(0);
}

/// Changes the environment, which other instances read. One entry is in memory that is unloaded with the library.
static void change_environment(void) {
  static char own_entry[] = "PROBE_ENTRY=1";
  setenv("PROBE_INTEGRAL", "7", 1);
  setenv("TZ", "PST8PDT", 1);
  unsetenv("PROBE_HOME");
  putenv(own_entry);
}

/// Changes settings of the calling thread, and starts timers.
static void meddle_with_thread(void) {
  static char stack[1 << 16];
  const stack_t own_stack = {.ss_sp = stack, .ss_size = sizeof stack};
  sigaltstack(&own_stack, NULL);
  sigset_t keys;
  sigemptyset(&keys);
  sigaddset(&keys, SIGINT);
  sigaddset(&keys, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &keys, NULL);
  signal(SIGINT, SIG_IGN);
  setpriority(PRIO_PROCESS, 0, 5);
  cpu_set_t processors;
  CPU_ZERO(&processors);
  CPU_SET(sched_getcpu(), &processors);
  sched_setaffinity(0, sizeof processors, &processors);
  prctl(PR_SET_PDEATHSIG, SIGUSR2);
  const struct itimerval later = {.it_value = {.tv_sec = 1000}};
  setitimer(ITIMER_REAL, &later, NULL);
  setitimer(ITIMER_PROF, &later, NULL);
  struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGRTMIN};
  timer_t timer;
  const struct itimerspec much_later = {.it_value = {.tv_sec = 1000}};
  if (timer_create(CLOCK_MONOTONIC, &event, &timer) == 0) timer_settime(timer, 0, &much_later, NULL);
}

// If one of these is set, unloading the library ends the process.
static int dies_at_end = 0;
static int exits_at_end = 0;
__attribute__((destructor)) static void end(void) {
  if (dies_at_end) raise(SIGSEGV);
  if (exits_at_end) exit(0);
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
#ifndef PROBE_STEADY
  if (c != NULL && strcmp(((Probe*)c)->state.strings[FAULT], "free_crash") == 0) raise(SIGSEGV);
  if (c != NULL && strcmp(((Probe*)c)->state.strings[FAULT], "free_meddle") == 0) meddle();
  if (c != NULL && strcmp(((Probe*)c)->state.strings[FAULT], "free_hang") == 0) {
    for (;;) pause();
  }
  if (c != NULL && strcmp(((Probe*)c)->state.strings[FAULT], "free_exit") == 0) exit(0);
  if (c != NULL && strcmp(((Probe*)c)->state.strings[FAULT], "free_throw") == 0) probe_throw("throw");
  if (c != NULL && strcmp(((Probe*)c)->state.strings[FAULT], "destructor") == 0) dies_at_end = 1;
  if (c != NULL && strcmp(((Probe*)c)->state.strings[FAULT], "destructor_exit") == 0) exits_at_end = 1;
#endif
  if (c != NULL) ((Probe*)c)->callbacks.freeMemory(c);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
  ((Probe*)c)->state.time = start;
  return fmi2OK;
}

// Runs in a thread that continues long after the FMU is freed.
static void* stay(void* nothing) {
  for (int i = 0; i < 100; ++i) usleep(1000);
  return nothing;
}

static void start_thread(void* (*work)(void*), void* argument) {
  pthread_t thread;
  if (pthread_create(&thread, NULL, work, argument) == 0) pthread_detach(thread);
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  Probe* p = c;
  compute(p);
  if (strcmp(p->state.strings[FAULT], "initialisation") == 0) {
    say(p, fmi2Error, "logStatusError", "this instance does not like its parameters", 0);
    return fmi2Error;
  }
#ifndef PROBE_STEADY
  if (strcmp(p->state.strings[FAULT], "meddle") == 0) meddle();
  if (strcmp(p->state.strings[FAULT], "set_environment") == 0) change_environment();
  if (strcmp(p->state.strings[FAULT], "meddle_thread") == 0) meddle_with_thread();
  if (strcmp(p->state.strings[FAULT], "early_throw") == 0) probe_throw("throw");
#endif
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  fill_buffer(c);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
  if (((Probe*)c)->file != 0) close(((Probe*)c)->file);
  say(c, fmi2OK, "console", "goodbye", ((Probe*)c)->state.time);
  return fmi2OK;
}

FMI2_ANSWER(fmi2OK, fmi2Reset, fmi2Component)

#define REALS_OF(c) (((Probe*)(c))->state.reals)
#define INTEGERS_OF(c) (((Probe*)(c))->state.integers)
#define BOOLEANS_OF(c) (((Probe*)(c))->state.booleans)
FMI2_VALUES(Real, REALS_OF, REALS, compute)
FMI2_VALUES(Integer, INTEGERS_OF, INTEGERS, compute)
FMI2_VALUES(Boolean, BOOLEANS_OF, BOOLEANS, compute)

FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
  for (size_t i = 0; i < n; ++i) {
    if (r[i] >= STRINGS) return fmi2Error;
    v[i] = ((Probe*)c)->bad_string && r[i] == STRING_OUT ? (const char*)8 : ((Probe*)c)->state.strings[r[i]];
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[]) {
  for (size_t i = 0; i < n; ++i) {
    if (r[i] >= STRINGS) return fmi2Error;
    strncpy(((Probe*)c)->state.strings[r[i]], v[i], TEXT_SIZE - 1);
  }
  compute(c);
  return fmi2OK;
}

static void read_past_a_file(void) {
  FILE* file = tmpfile();
  volatile char* bytes = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, fileno(file), 0);
  bytes[0] = 1;
}

static int deeper(int depth) {
  volatile char frame[4096];
  frame[depth % 4096] = (char)depth;
  return deeper(depth + 1) + frame[(depth + 1) % 4096];
}

// Uses memory without checking whether the allocation succeeded, as many programs do.
static void take_all_memory(void) {
  for (;;) {
    const size_t size = 16 << 20;
    memset(malloc(size), 1, size);
  }
}

// Calls the logger with an environment that may belong to another instance, as FMUs of some tools do.
static void say_for(Probe* p, void* environment, const char* name, const char* text) {
  p->callbacks.logger(environment, name, fmi2Warning, "logStatusWarning", text);
}

static void* say_from_a_thread(void* argument) {
  Probe* p = argument;
  say_for(p, p->callbacks.componentEnvironment, p->name, "own environment");
  say_for(p, (void*)1, p->name, "foreign environment");
  say_for(p, NULL, "nobody", "no environment");
  return NULL;
}

// Misuses the logger in the way that `fault` selects. Returns 0 if `fault` does not select a misuse of the logger.
static int abuse_logger(Probe* p, const char* fault) {
  void* own = p->callbacks.componentEnvironment;
  if (strcmp(fault, "log_foreign") == 0) {
    say_for(p, (void*)1, p->name, "foreign environment");
    say_for(p, NULL, p->name, "no environment");
    say_for(p, (void*)1, (const char*)8, "a name that cannot be read");
  } else if (strcmp(fault, "log_thread") == 0) {
    pthread_t thread;
    pthread_create(&thread, NULL, say_from_a_thread, p);
    pthread_join(thread, NULL);
  } else if (strcmp(fault, "log_format") == 0) {
    p->callbacks.logger(own, p->name, fmi2Warning, "", "%s and %n and %5d", (const char*)16, (int*)24, 7);
    p->callbacks.logger(own, p->name, fmi2Warning, "", "%999999999d|%y|%d", 1);
    p->callbacks.logger(own, p->name, fmi2Warning, "", (const char*)32);
    p->callbacks.logger(own, p->name, fmi2Warning, NULL, NULL);
  } else if (strcmp(fault, "log_bytes") == 0) {
    say_for(p, own, p->name, "caf\xe9 \x1b[2J two\nlines");
  } else if (strcmp(fault, "log_errors") == 0) {
    say(p, fmi2Error, "logStatusError", "it goes on all the same", p->state.time);
  } else {
    return 0;
  }
  return 1;
}

/// Returns the address of the memory that the master shares under this name; null if it does not share it.
static char* shared_memory(const char* name) {
  FILE* maps = fopen("/proc/self/maps", "r");
  char line[512];
  unsigned long start = 0;
  while (maps != NULL && start == 0 && fgets(line, sizeof line, maps) != NULL) {
    if (strstr(line, name) != NULL) start = strtoul(line, NULL, 16);
  }
  if (maps != NULL) fclose(maps);
  return (char*)start;
}

/// Offsets of members of `Control` (master/src/slave/isolation/protocol.hpp).
enum { ANSWER_BYTES = 24, LOG_BYTES = 32, CALLS = 44, ANSWERED = 8 };

/// Increases the number of calls without end, as if the next call had started.
static void* forge_calls(void* place) {
  for (;;) ++*(volatile uint32_t*)place;
}

static void forge(const char* fault) {
  char* control = shared_memory("mebots-control");
  if (control == NULL) return;
  if (strcmp(fault, "forge_log") == 0) *(volatile uint64_t*)(control + LOG_BYTES) = (uint64_t)1 << 40;
  if (strcmp(fault, "forge_length") == 0) *(volatile uint64_t*)(control + ANSWER_BYTES) = (uint64_t)1 << 40;
  if (strcmp(fault, "forge_answer") == 0) {
    enum { SOME = 64 };
    memset(shared_memory("mebots-answers"), 0xff, SOME);
    *(volatile uint64_t*)(control + ANSWER_BYTES) = SOME;
  }
  if (strcmp(fault, "forge_calls") == 0) {
    start_thread(&forge_calls, control + CALLS);
  } else {
    *(volatile uint32_t*)(control + ANSWERED) += 1;  // forges the end of the call
  }
  for (;;) pause();
}

/// Returns true if the system refused the call, or if a process namespace hides the other process.
static int refused(long answer) {
  return answer == -1 && (errno == EPERM || errno == EACCES || errno == ESRCH || errno == ENOENT);
}

/// Opens a file or folder of a process in /proc. Returns -1 if this fails.
static int open_of(pid_t process, const char* what, int access) {
  char path[64];
  snprintf(path, sizeof path, "/proc/%d/%s", process, what);
  return open(path, access | O_CLOEXEC);
}

/// Sends signals in every form that the kernel offers. Returns true if all were refused.
static int takes_no_signal(pid_t process) {
  siginfo_t info = {.si_signo = SIGKILL, .si_code = SI_QUEUE};
  const int folder = open_of(process, "", O_RDONLY | O_DIRECTORY);
  const int by_number = refused(kill(process, SIGKILL)) && refused(syscall(SYS_tkill, process, SIGKILL)) &&
                        refused(syscall(SYS_tgkill, process, process, SIGKILL)) &&
                        refused(syscall(SYS_rt_sigqueueinfo, process, SIGKILL, &info)) &&
                        refused(syscall(SYS_rt_tgsigqueueinfo, process, process, SIGKILL, &info));
  const int descriptor = (int)syscall(SYS_pidfd_open, process, 0);
  const int by_descriptor = descriptor < 0 || refused(syscall(SYS_pidfd_send_signal, descriptor, SIGKILL, NULL, 0));
  const long to_folder = folder < 0 ? -1 : syscall(SYS_pidfd_send_signal, folder, SIGKILL, NULL, 0);
  const int by_folder =
      folder < 0 || refused(to_folder) || (to_folder == -1 && errno == EINVAL);  // of no namespace here
  if (descriptor >= 0) close(descriptor);
  if (folder >= 0) close(folder);
  return by_number && by_descriptor && by_folder;
}

static int is_not_changed(pid_t process) {
  const struct rlimit no_time = {0, 0};
  char byte = 0;
  const struct iovec bytes = {&byte, 1};
  return refused(prlimit(process, RLIMIT_CPU, &no_time, NULL)) &&
         refused(process_vm_writev(process, &bytes, 1, &bytes, 1, 0)) &&
         refused(ptrace(PTRACE_ATTACH, process, 0, 0)) && refused(open_of(process, "mem", O_RDWR)) &&
         refused(fcntl(0, F_SETOWN, process)) && refused(fcntl(0, F_SETSIG, SIGKILL));
}

/// Tries every way to harm its parent and a process whose number the test provides. If a way is not refused, ends the
/// run. In a separate process namespace, neither process is visible.
static void harm_others(void) {
  const char* bystander = getenv("MEBOTS_TEST_BYSTANDER");
  if (getppid() == 1) return;
  const pid_t others[] = {getppid(), bystander == NULL ? getppid() : (pid_t)atoi(bystander)};
  for (int i = 0; i < 2; ++i) {
    if (!takes_no_signal(others[i]) || !is_not_changed(others[i])) abort();
  }
}

/// Starts and ends a process, as FMUs with a helper program do.
static void end_child(void) {
  const pid_t child = fork();
  if (child == 0) {
    for (;;) pause();
  }
  int status = 0;
  if (kill(child, SIGTERM) != 0 || waitpid(child, &status, 0) != child || WTERMSIG(status) != SIGTERM) abort();
}

static void* end_from_thread(void* unused) {
  (void)unused;
  _exit(0);
}

static void end_from_handler(int signal_number) {
  (void)signal_number;
  _exit(0);
}

/// Ends the process, or a forked process. `fault` selects the way. "kernel_exit" bypasses the C library.
static void end_process(const char* fault) {
  if (strcmp(fault, "exit") == 0) exit(3);
  if (strcmp(fault, "quick_exit") == 0) quick_exit(0);
  if (strcmp(fault, "_exit") == 0) _exit(0);
  if (strcmp(fault, "_Exit") == 0) _Exit(0);
  if (strcmp(fault, "handler__exit") == 0) {
    signal(SIGUSR1, end_from_handler);
    raise(SIGUSR1);
  }
  if (strcmp(fault, "threads__exit") == 0) {
    enum { kThreads = 8 };
    pthread_t threads[kThreads];
    for (int i = 0; i < kThreads; ++i) pthread_create(&threads[i], NULL, end_from_thread, NULL);
    for (int i = 0; i < kThreads; ++i) pthread_join(threads[i], NULL);
  }
  if (strcmp(fault, "kernel_exit") == 0) syscall(SYS_exit_group, 0);
  if (strcmp(fault, "child_exit") == 0 || strcmp(fault, "child__exit") == 0) {
    const pid_t child = fork();
    if (child == 0) end_process(fault + strlen("child_"));
    int status = 0;
    if (waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) == EXIT_FAILURE) abort();
  }
}

/// Ends the thread, copies or replaces the process, or ends it by a signal. `fault` selects the way.
static void leave(Probe* p, const char* fault) {
  if (strcmp(fault, "pthread_exit") == 0) pthread_exit(NULL);
  if (strcmp(fault, "cancel") == 0 || strcmp(fault, "enabled_cancel") == 0) {
    if (strcmp(fault, "enabled_cancel") == 0) pthread_setcancelstate(PTHREAD_CANCEL_ENABLE, NULL);
    pthread_cancel(pthread_self());
    pthread_testcancel();
  }
  if (strcmp(fault, "exec") == 0) execl("/bin/true", "true", (char*)NULL);
  if (strcmp(fault, "alarm") == 0 || strcmp(fault, "alarm_later") == 0) {
    const struct itimerval soon = {.it_value = {.tv_usec = 3000}};
    if (!p->was_bad) setitimer(ITIMER_REAL, &soon, NULL);
    p->was_bad = 1;
    if (strcmp(fault, "alarm_later") == 0) {
      usleep(2000);
    } else {
      while (p->zero == 0) usleep(1000);
    }
  }
  if (strcmp(fault, "usr1") == 0) raise(SIGUSR1);
  if (strcmp(fault, "block") == 0 && !p->was_bad) {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, NULL);
    p->was_bad = 1;
  }
  if (p->was_bad) return;
  if (strcmp(fault, "fork_returns") == 0 || strcmp(fault, "vfork_returns") == 0) {
    p->was_bad = 1;
    if (fault[0] == 'v') {
      (void)!vfork();
    } else {
      (void)!fork();
    }
  }
}

/// Sends many long messages in one call.
static void flood_log(Probe* p) {
  enum { kMessages = 600, kBytes = 65000 };
  char* text = calloc(1, kBytes + 1);
  memset(text, 'x', kBytes);
  for (int i = 0; i < kMessages && !p->was_bad; ++i) say(p, fmi2Warning, "logStatusWarning", text, i);
  p->was_bad = 1;
  free(text);
}

/// Starts a process in a new session, and ends the process's parent. Then hangs.
static void leave_daemon(void) {
  const pid_t between = fork();
  if (between == 0) {
    setsid();
    if (fork() != 0) _exit(0);
  }
  for (;;) pause();
}

#ifdef PROBE_STEADY
static fmi2Status misbehave(Probe* p, const char* fault) {
  (void)p;
  if (strcmp(fault, "slow") == 0) usleep(20000);
  return strcmp(fault, "error") == 0 ? fmi2Error : fmi2OK;
}
#else
static fmi2Status misbehave(Probe* p, const char* fault) {
  if (abuse_logger(p, fault)) return fmi2OK;
  if (strcmp(fault, "warning") == 0) {
    say(p, fmi2Warning, "logStatusWarning", "something is odd", p->state.time);
    return fmi2Warning;
  }
  if (strcmp(fault, "discard") == 0) return fmi2Discard;
  if (strcmp(fault, "terminate") == 0) {
    p->state.terminated = 1;
    return fmi2Discard;
  }
  if (strcmp(fault, "error") == 0) {
    say(p, fmi2Error, "logStatusError", "#r0# made it fail", p->state.reals[REAL_IN]);
    return fmi2Error;
  }
  if (strcmp(fault, "fatal") == 0) return fmi2Fatal;
  if (strncmp(fault, "read_file ", 10) == 0 && access(fault + 10, R_OK) != 0) return fmi2Error;
  if (strcmp(fault, "nan") == 0) p->state.reals[REAL_OUT] = NAN;
  if (strcmp(fault, "read_environment") == 0 && getenv("PROBE_INTEGRAL") != NULL)
    p->state.reals[INTEGRAL] = atof(getenv("PROBE_INTEGRAL"));
  if (strcmp(fault, "infinity") == 0) p->state.reals[INTEGRAL] = -INFINITY;
  if (strcmp(fault, "slow") == 0) usleep(20000);
  if (strcmp(fault, "nap") == 0) usleep(1500);
  // Sends the signal of Ctrl-C once for the folder that string_in names, even if the step is repeated. Uses a folder,
  // because a file would count as an input of the run.
  if (strcmp(fault, "interrupt") == 0 && mkdir(p->state.strings[STRING_IN], 0700) == 0) raise(SIGINT);
  if (strcmp(fault, "crash") == 0) raise(SIGSEGV);
  if (strcmp(fault, "null") == 0) *(volatile int*)p->null = 1;
  if (strcmp(fault, "bus") == 0) read_past_a_file();
  if (strcmp(fault, "division") == 0) p->state.integers[STEPS] /= p->zero;
  if (strcmp(fault, "illegal") == 0) __builtin_trap();
  if (strcmp(fault, "abort") == 0) abort();
  end_process(fault);
  leave(p, fault);
  if (strncmp(fault, "throw", 5) == 0) probe_throw(fault);
  if (strcmp(fault, "bad_string") == 0) p->bad_string = 1;
  if (strcmp(fault, "log_flood") == 0) flood_log(p);
  if (strcmp(fault, "upward") == 0) fesetround(FE_UPWARD);
  if (strcmp(fault, "open_masks") == 0 && p->state.time + p->state.reals[LAST_STEP] < p->state.reals[FAULT_TIME] + 1e-6)
    umask(0);
  if (strcmp(fault, "own_file") == 0 && p->file == 0) p->file = open("/dev/null", O_RDONLY);
  if (strcmp(fault, "thread_stays") == 0 && !p->has_thread) {
    p->has_thread = 1;
    start_thread(&stay, NULL);
  }
  if (strcmp(fault, "hang") == 0) {
    while (p->zero == 0) usleep(1000);
  }
  if (strcmp(fault, "stack") == 0) p->state.integers[STEPS] = deeper(p->state.integers[STEPS]);
  if (strcmp(fault, "memory") == 0) take_all_memory();
  if (strcmp(fault, "close") == 0) {
    for (int file = 0; file < 1024; ++file) close(file);
  }
  if (strcmp(fault, "kill_parent") == 0) {
    kill(getppid(), SIGKILL);
    kill(-getpgid(getppid()), SIGKILL);
  }
  if (strcmp(fault, "kill_group") == 0) kill(0, SIGKILL);
  if (strcmp(fault, "harm_others") == 0) harm_others();
  if (strcmp(fault, "end_child") == 0) end_child();
  if (strncmp(fault, "forge_", 6) == 0) forge(fault);
#if defined(__x86_64__)
  if (strcmp(fault, "foreign_call") == 0) {  // calls kill(parent, SIGKILL) by the system call of 32-bit programs
    long answer = 37;
    __asm__ volatile("int $0x80" : "+a"(answer) : "b"(getppid()), "c"(SIGKILL));
  }
#endif
  if (strcmp(fault, "orphan") == 0 && fork() == 0) {
    for (;;) pause();
  }
  if (strcmp(fault, "daemon") == 0) leave_daemon();
  return fmi2OK;
}
#endif

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set) {
  Probe* p = c;
  State* s = &p->state;
  if (!no_set) s->integers[SET_BACKS] += 1;
  s->time = t;
  s->reals[INTEGRAL] += h * s->reals[REAL_IN];
  s->reals[LAST_END] = t + h;
  s->reals[LAST_STEP] = h;
  s->integers[STEPS] += 1;
  take_buffer(p);
  fill_buffer(p);
  if (s->integers[STEPS] == 1) say(p, fmi2OK, "console", "hello from the first step", h);
  if (s->integers[STEPS] == 1) say(p, fmi2OK, "chatter", "nobody asked for this", h);
  return t + h > s->reals[FAULT_TIME] - h / 2 ? misbehave(p, s->strings[FAULT]) : fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = ((Probe*)c)->state.time + ((Probe*)c)->state.reals[LAST_STEP] / 4;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = ((Probe*)c)->state.terminated;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  if (*state == NULL) *state = malloc(sizeof(State));
  memcpy(*state, &((Probe*)c)->state, sizeof(State));
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  memcpy(&((Probe*)c)->state, state, sizeof(State));
  show_buffer(c);  // a state cannot contain the address, because each instance has its own buffers
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  (void)c;
  free(*state);
  *state = NULL;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) {
  (void)state;
  *size = sizeof(State);
  if (strcmp(((Probe*)c)->state.strings[FAULT], "huge_state") == 0) *size = (size_t)1 << 45;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  (void)c;
  memcpy(bytes, state, size);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate* state) {
  (void)c;
  if (size != sizeof(State)) return fmi2Error;
  *state = malloc(size);
  memcpy(*state, bytes, size);
  return fmi2OK;
}
