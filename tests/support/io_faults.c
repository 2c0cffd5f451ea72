// SPDX-License-Identifier: Apache-2.0
// Makes calls of the C library for files of one folder fail. LD_PRELOAD loads this library; tests/support/io_faults.py
// builds and controls it. A fault consists of a kind of call, the number of the call, and an error. A "sticky" fault
// also applies to all later calls.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/uio.h>
#include <unistd.h>

enum { WRITE, PWRITE, FSYNC, FDATASYNC, RENAME, LINK, CLOSE, FTRUNCATE, KINDS };

static char folder[PATH_MAX];
static const char* flag;  // while this file exists, each write fails
static int fault_kind;    // -1: calls of all kinds
static int error_number;  // 0: only counts calls; -1: writes half of the bytes
static int sticky;
static long fail_at;
static long seen;  // calls of the kind that fails
static long own_counts[KINDS];
static long* counts = own_counts;

// Makes the nth call of the kind fail.
void arm(const char* in, int kind, int error, long nth, int fails_on) {
  snprintf(folder, sizeof folder, "%s", in);
  fault_kind = kind;
  error_number = error;
  fail_at = nth;
  sticky = fails_on;
  seen = 0;
  memset(counts, 0, KINDS * sizeof *counts);
}

long count(int kind) {
  if (kind >= 0) return counts[kind];
  long all = 0;
  for (int i = 0; i < KINDS; ++i) all += counts[i];
  return all;
}

static long number_of(const char* variable) {
  const char* text = getenv(variable);
  return text == NULL ? 0 : atol(text);
}

// IO_FAULTS_COUNTS is the path of a file with one counter for each kind of call. The file keeps the counters even if
// the process crashes.
__attribute__((constructor)) static void read_environment(void) {
  flag = getenv("IO_FAULTS_FLAG");
  const char* in = getenv("IO_FAULTS_FOLDER");
  const char* file = getenv("IO_FAULTS_COUNTS");
  if (file != NULL) {
    const int descriptor = open(file, O_RDWR | O_CLOEXEC);
    void* shared = mmap(NULL, sizeof own_counts, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (shared != MAP_FAILED) counts = shared;
  }
  if (in == NULL) return;
  arm(in, (int)number_of("IO_FAULTS_KIND"), (int)number_of("IO_FAULTS_ERROR"), number_of("IO_FAULTS_NTH"),
      (int)number_of("IO_FAULTS_STICKY"));
}

// Returns 1 for a path in the folder. Ignores the folder's lock, which is not a result.
static int is_inside(const char* path) {
  return folder[0] != 0 && strncmp(path, folder, strlen(folder)) == 0 && strstr(path, ".mebots.lock") == NULL;
}

static int is_of_folder(int descriptor) {
  char link[64];
  char path[PATH_MAX];
  if (folder[0] == 0) return 0;
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size <= 0) return 0;
  path[size] = 0;
  return is_inside(path);
}

// Ignores files that are only read, because a failed close loses no data of them.
static int is_written(int descriptor) {
  return (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY && is_of_folder(descriptor);
}

static int fails(int kind, int inside) {
  if (!inside || flag != NULL) return 0;
  ++counts[kind];
  if (error_number == 0 || (fault_kind >= 0 && fault_kind != kind)) return 0;
  ++seen;
  return sticky ? seen >= fail_at : seen == fail_at;
}

static int is_full(int descriptor) {
  return flag != NULL && access(flag, F_OK) == 0 && is_of_folder(descriptor);
}

#define REAL(name) __typeof__(&name) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)
#define FAIL_IF_FULL         \
  if (is_full(descriptor)) { \
    errno = ENOSPC;          \
    return -1;               \
  }
#define FAIL_IF(kind, inside)                    \
  if (fails(kind, inside) && error_number > 0) { \
    errno = error_number;                        \
    return -1;                                   \
  }

ssize_t write(int descriptor, const void* bytes, size_t size) {
  REAL(write);
  FAIL_IF_FULL
  if (!fails(WRITE, is_of_folder(descriptor))) return real(descriptor, bytes, size);
  if (error_number == -1) return real(descriptor, bytes, size > 1 ? size / 2 : size);
  errno = error_number;
  return -1;
}

ssize_t writev(int descriptor, const struct iovec* parts, int number) {
  REAL(writev);
  FAIL_IF_FULL
  if (!fails(WRITE, is_of_folder(descriptor))) return real(descriptor, parts, number);
  if (error_number == -1) return real(descriptor, parts, number > 1 ? number / 2 : number);
  errno = error_number;
  return -1;
}

static ssize_t write_at(int descriptor, const void* bytes, size_t size, off_t place) {
  ssize_t (*real)(int, const void*, size_t, off_t) = dlsym(RTLD_NEXT, "pwrite64");
  FAIL_IF_FULL
  if (!fails(PWRITE, is_of_folder(descriptor))) return real(descriptor, bytes, size, place);
  if (error_number == -1) return real(descriptor, bytes, size > 1 ? size / 2 : size, place);
  errno = error_number;
  return -1;
}

ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t place) {
  return write_at(descriptor, bytes, size, place);
}

ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off_t place) {
  return write_at(descriptor, bytes, size, place);
}

int fsync(int descriptor) {
  REAL(fsync);
  FAIL_IF(FSYNC, is_of_folder(descriptor))
  return real(descriptor);
}

int fdatasync(int descriptor) {
  REAL(fdatasync);
  FAIL_IF(FDATASYNC, is_of_folder(descriptor))
  return real(descriptor);
}

int ftruncate(int descriptor, off_t size) {
  REAL(ftruncate);
  FAIL_IF(FTRUNCATE, is_of_folder(descriptor))
  return real(descriptor, size);
}

int ftruncate64(int descriptor, off_t size) {
  REAL(ftruncate64);
  FAIL_IF(FTRUNCATE, is_of_folder(descriptor))
  return real(descriptor, size);
}

int rename(const char* from, const char* to) {
  REAL(rename);
  FAIL_IF(RENAME, is_inside(to))
  return real(from, to);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  REAL(renameat);
  FAIL_IF(RENAME, is_inside(to))
  return real(from_folder, from, to_folder, to);
}

int link(const char* from, const char* to) {
  REAL(link);
  FAIL_IF(LINK, is_inside(to))
  return real(from, to);
}

int close(int descriptor) {
  REAL(close);
  const int failed = fails(CLOSE, is_written(descriptor)) && error_number > 0;
  const int result = real(descriptor);  // as Linux does: the descriptor is closed in any case
  if (!failed) return result;
  errno = error_number;
  return -1;
}
