// SPDX-License-Identifier: Apache-2.0
// Makes calls of the C library on files of one folder fail, for io_fault_test.py, which loads this by LD_PRELOAD.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

static char folder[PATH_MAX];
static const char* flag;  // while this file exists, each write fails
static int error_number;  // 0 counts calls alone; -1 writes half of the bytes
static long fail_at;
static long calls;

// The nth counted call fails.
void arm(const char* in, int error, long nth) {
  snprintf(folder, sizeof folder, "%s", in);
  error_number = error;
  fail_at = nth;
  calls = 0;
}

long count(void) {
  return calls;
}

__attribute__((constructor)) static void read_environment(void) {
  flag = getenv("IO_FAULTS_FLAG");
  if (flag != NULL) arm(getenv("IO_FAULTS_FOLDER"), 0, 0);
}

static int is_inside(const char* path) {
  // The HDF5 library has tests of its own.
  return folder[0] != 0 && strncmp(path, folder, strlen(folder)) == 0 && strstr(path, "tables.h5") == NULL;
}

static int is_of_folder(int descriptor) {
  char link[64];
  char path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size <= 0) return 0;
  path[size] = 0;
  return is_inside(path);
}

static int fails(int inside) {
  if (!inside) return 0;
  if (flag != NULL) return 0;
  return ++calls == fail_at && error_number != 0;
}

static int is_full(int descriptor) {
  return flag != NULL && access(flag, F_OK) == 0 && is_of_folder(descriptor);
}

#define REAL(name) __typeof__(&name) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

ssize_t write(int descriptor, const void* bytes, size_t size) {
  REAL(write);
  if (is_full(descriptor)) {
    errno = ENOSPC;
    return -1;
  }
  if (!fails(is_of_folder(descriptor))) return real(descriptor, bytes, size);
  if (error_number == -1) return real(descriptor, bytes, size > 1 ? size / 2 : size);
  errno = error_number;
  return -1;
}

ssize_t writev(int descriptor, const struct iovec* parts, int number) {
  REAL(writev);
  if (!is_full(descriptor)) return real(descriptor, parts, number);
  errno = ENOSPC;
  return -1;
}

#define FAIL_IF(inside)                    \
  if (fails(inside) && error_number > 0) { \
    errno = error_number;                  \
    return -1;                             \
  }

int fsync(int descriptor) {
  REAL(fsync);
  FAIL_IF(is_of_folder(descriptor))
  return real(descriptor);
}

int fdatasync(int descriptor) {
  REAL(fdatasync);
  FAIL_IF(is_of_folder(descriptor))
  return real(descriptor);
}

int rename(const char* from, const char* to) {
  REAL(rename);
  FAIL_IF(is_inside(to))
  return real(from, to);
}

int close(int descriptor) {
  REAL(close);
  const int failed = fails(is_of_folder(descriptor)) && error_number > 0;
  const int result = real(descriptor);  // as Linux does: the descriptor is closed in any case
  if (!failed) return result;
  errno = error_number;
  return -1;
}
