// SPDX-License-Identifier: Apache-2.0
// Runs an FMU of FMI 2.0 or 3.0 on any platform. A list of orders controls it. Prints all bits of the values that it
// reads. Shares no code and no header with MEbots: it declares the functions as the standard does.
//
//   run_fmu < ORDERS
//
// An order is a line of UTF-8 text; numbers are bits in hexadecimal:
//   library PATH | guid TEXT | resources TEXT | instantiate VERSION | enter | exit | initialise | step TIME LENGTH
//   real|integer|boolean|string REFERENCE VALUE... | read real|integer|int64|boolean|string REFERENCE COUNT
//   text REFERENCE | answer
// `enter` and `exit` begin and end initialisation, `initialise` does both.
// `read string` prints a hash, `text` the string itself. `answer` ends the line of output and flushes it.
// The resources are a file URI for FMI 2.0, and a folder for FMI 3.0.
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
static void* open_library(const char* path) {
  wchar_t wide[4096];
  MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 4096);
  return (void*)LoadLibraryW(wide);
}
static void* symbol(void* library, const char* name) {
  return (void*)GetProcAddress((HMODULE)library, name);
}
static int close_library(void* library) {
  return FreeLibrary((HMODULE)library) ? 0 : 1;
}
#else
#include <dlfcn.h>
static void* open_library(const char* path) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == NULL) fprintf(stderr, "run_fmu: %s\n", dlerror());
  return library;
}
static void* symbol(void* library, const char* name) {
  return dlsym(library, name);
}
static int close_library(void* library) {
  return dlclose(library);
}
#endif

typedef void* Component;
typedef uint32_t Reference;
typedef struct {
  void (*logger)(void*, const char*, int, const char*, const char*, ...);
  void* (*allocate)(size_t, size_t);
  void (*release)(void*);
  void (*step_finished)(void*, int);
  void* environment;
} Callbacks;

static void* fmu;
static Component component;
static int version;
static char guid[200];
static char resources[4096];

static void fail(const char* what) {
  fprintf(stderr, "run_fmu: %s\n", what);
  exit(1);
}

static void* function(const char* name) {
  char full[100];
  snprintf(full, sizeof full, "fmi%d%s", version, name);
  void* found = symbol(fmu, full);
  if (found == NULL) fail(full);
  return found;
}

static void check(int status, const char* what) {
  if (status > 1) fail(what);
}

static void log_fmi2(void* environment, const char* instance, int status, const char* category, const char* format,
                     ...) {
  (void)environment;
  va_list arguments;
  va_start(arguments, format);
  fprintf(stderr, "%s [%d, %s] ", instance, status, category);
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
  va_end(arguments);
}

static void log_fmi3(void* environment, int status, const char* category, const char* message) {
  (void)environment;
  fprintf(stderr, "[%d, %s] %s\n", status, category, message);
}

static void instantiate(void) {
  static Callbacks callbacks = {log_fmi2, calloc, free, NULL, NULL};
  if (version == 2) {
    typedef Component (*Instantiate)(const char*, int, const char*, const char*, const Callbacks*, int, int);
    component = ((Instantiate)function("Instantiate"))("one", 1, guid, resources, &callbacks, 0, 0);
  } else {
    typedef Component (*Instantiate)(const char*, const char*, const char*, _Bool, _Bool, _Bool, _Bool,
                                     const Reference*, size_t, void*, void (*)(void*, int, const char*, const char*),
                                     void*);
    component = ((Instantiate)function("InstantiateCoSimulation"))("one", guid, resources, 0, 0, 0, 0, NULL, 0, NULL,
                                                                   log_fmi3, NULL);
  }
  if (component == NULL) fail("there is no instance");
}

static void enter_initialisation(void) {
  if (version == 2) {
    check(((int (*)(Component, int, double, double, int, double))function("SetupExperiment"))(component, 0, 0, 0, 0, 0),
          "SetupExperiment");
    check(((int (*)(Component))function("EnterInitializationMode"))(component), "EnterInitializationMode");
  } else {
    typedef int (*Enter)(Component, _Bool, double, double, _Bool, double);
    check(((Enter)function("EnterInitializationMode"))(component, 0, 0, 0, 0, 0), "EnterInitializationMode");
  }
}

static void exit_initialisation(void) {
  check(((int (*)(Component))function("ExitInitializationMode"))(component), "ExitInitializationMode");
}

static void step(double time, double length) {
  if (version == 2) {
    check(((int (*)(Component, double, double, int))function("DoStep"))(component, time, length, 1), "DoStep");
    return;
  }
  typedef int (*Step)(Component, double, double, _Bool, _Bool*, _Bool*, _Bool*, double*);
  _Bool event = 0, terminate = 0, early = 0;
  double last = 0;
  check(((Step)function("DoStep"))(component, time, length, 1, &event, &terminate, &early, &last), "DoStep");
}

static double real_of(const char* bits) {
  const uint64_t number = strtoull(bits, NULL, 16);
  double value;
  memcpy(&value, &number, sizeof value);
  return value;
}

// In FMI 2.0, a Boolean is an int, and there are no arrays. In FMI 3.0, a Boolean is a byte, an integer has 32 bits,
// and an enumeration has 64.
enum { kMost = 1024 };
typedef int (*Access)(Component, const Reference*, size_t, void*);
typedef int (*AccessArray)(Component, const Reference*, size_t, void*, size_t);

static int access(const char* way, const char* type, Reference reference, void* values, size_t count) {
  char name[40];
  const int real = strcmp(type, "real") == 0, integer = strcmp(type, "integer") == 0,
            text = strcmp(type, "string") == 0;
  const char* of2 = real ? "Real" : integer ? "Integer" : text ? "String" : "Boolean";
  const char* of3 = strcmp(type, "int64") == 0 ? "Int64"
                    : real                     ? "Float64"
                    : integer                  ? "Int32"
                    : text                     ? "String"
                                               : "Boolean";
  snprintf(name, sizeof name, "%s%s", way, version == 2 ? of2 : of3);
  if (version == 2) return ((Access)function(name))(component, &reference, count, values);
  return ((AccessArray)function(name))(component, &reference, 1, values, count);
}

// Sets a Real or Float64 from values separated by blanks. strtok() has already returned the first value.
static void set_reals(Reference reference, const char* value) {
  static double reals[kMost];
  size_t count = 0;
  for (; value != NULL && count < kMost; value = strtok(NULL, " ")) reals[count++] = real_of(value);
  check(access("Set", "real", reference, reals, count), "Set");
}

static void set(const char* type, Reference reference, char* value) {
  int32_t integer = (int32_t)strtoul(value, NULL, 16);
  _Bool flag = integer != 0;
  const char* text = value;
  void* place = strcmp(type, "string") == 0 ? (void*)&text : (void*)&integer;
  if (strcmp(type, "boolean") == 0 && version == 3) place = &flag;
  check(access("Set", type, reference, place, 1), "Set");
}

static void read_values(const char* type, Reference reference, size_t count) {
  static union {
    uint64_t bits[kMost];
    int32_t integers[kMost];
    _Bool flags[kMost];
    const char* texts[kMost];
  } values;
  if (count > kMost) fail("too many elements");
  check(access("Get", type, reference, &values, count), "Get");
  for (size_t i = 0; i < count; ++i) {
    if (strcmp(type, "real") == 0 || strcmp(type, "int64") == 0) {
      printf(" %016llx", (unsigned long long)values.bits[i]);
    } else if (strcmp(type, "string") == 0) {
      uint64_t hash = 14695981039346656037ULL;  // FNV-1a
      for (const char* c = values.texts[i]; *c != '\0'; ++c) hash = (hash ^ (unsigned char)*c) * 1099511628211ULL;
      printf(" %016llx", (unsigned long long)hash);
    } else {
      printf(" %x", strcmp(type, "boolean") == 0 && version == 3 ? values.flags[i] : (unsigned)values.integers[i]);
    }
  }
}

static void print_text(Reference reference) {
  const char* text = NULL;
  check(access("Get", "string", reference, &text, 1), "Get");
  printf(" %s", text);
}

// Executes an order. `rest` is the line after the order's name.
static void perform(const char* order, char* rest) {
  if (strcmp(order, "library") == 0) {
    fmu = open_library(rest);
    if (fmu == NULL) fail("the library cannot be loaded");
  } else if (strcmp(order, "guid") == 0) {
    snprintf(guid, sizeof guid, "%s", rest);
  } else if (strcmp(order, "resources") == 0) {
    snprintf(resources, sizeof resources, "%s", rest);
  } else if (strcmp(order, "instantiate") == 0) {
    version = atoi(rest);
    instantiate();
  } else if (strcmp(order, "enter") == 0) {
    enter_initialisation();
  } else if (strcmp(order, "exit") == 0) {
    exit_initialisation();
  } else if (strcmp(order, "initialise") == 0) {
    enter_initialisation();
    exit_initialisation();
  } else if (strcmp(order, "text") == 0) {
    print_text((Reference)strtoul(rest, NULL, 10));
  } else if (strcmp(order, "answer") == 0) {
    putchar('\n');
    fflush(stdout);
  } else {
    char* first = strtok(rest, " ");
    char* second = strtok(NULL, strcmp(order, "string") == 0 ? "" : " ");
    if (strcmp(order, "step") == 0) {
      step(real_of(first), real_of(second));
    } else if (strcmp(order, "read") == 0) {
      read_values(first, (Reference)strtoul(second, NULL, 10), strtoul(strtok(NULL, " "), NULL, 10));
    } else if (strcmp(order, "real") == 0) {
      set_reals((Reference)strtoul(first, NULL, 10), second);
    } else {
      set(order, (Reference)strtoul(first, NULL, 10), second == NULL ? (char*)"" : second);
    }
  }
}

int main(void) {
  static char line[1 << 19];  // a text may be a whole picture
  while (fgets(line, sizeof line, stdin) != NULL) {
    line[strcspn(line, "\r\n")] = '\0';
    char* rest = strchr(line, ' ');
    if (rest != NULL) *rest++ = '\0';
    perform(line, rest == NULL ? line + strlen(line) : rest);
  }
  putchar('\n');
  check(((int (*)(Component))function("Terminate"))(component), "Terminate");
  ((void (*)(Component))function("FreeInstance"))(component);
  return close_library(fmu);
}
