/* Makes the k-th change of a file below a folder fail with ENOSPC, as a full disk does. Loaded with LD_PRELOAD, and armed
   by full_disk.py through ctypes. What only frees space (unlink, rmdir, close) never fails. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static char folder[PATH_MAX];
static atomic_long seen, failed;
static long first = 0; /* the change that fails, counted from 1; 0: none */
static int lasting;    /* whether all after it fail too */

void disk_arm(const char *below, long change, int for_good) {
  seen = failed = 0;
  first = change;
  lasting = for_good;
  strncpy(folder, below, sizeof folder - 1);
}
long disk_seen(void) { return seen; }
long disk_failed(void) { return failed; }

static int is_below(const char *path) {
  size_t length = strlen(folder);
  return length && path && !strncmp(path, folder, length) && (path[length] == '/' || !path[length]);
}

static int is_full(void) {
  long now = ++seen;
  if (!first || now < first || (now > first && !lasting)) return 0;
  ++failed;
  errno = ENOSPC;
  return 1;
}

static int fails_at(const char *path) { return is_below(path) && is_full(); }

static int fails_in(int file) {
  char link[64], path[PATH_MAX];
  if (!folder[0] || file < 0) return 0;
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = 0;
  return fails_at(path);
}

#define REAL(name) \
  static __typeof__(&name) real; \
  if (!real) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

#define OPEN(name, parameters, values) \
  int name parameters { \
    REAL(name); \
    mode_t mode = 0; \
    if (flags & (O_CREAT | __O_TMPFILE)) { \
      va_list rest; \
      va_start(rest, flags); \
      mode = va_arg(rest, mode_t); \
      va_end(rest); \
    } \
    if (flags & O_CREAT && access(path, F_OK) && fails_at(path)) return -1; \
    return real values; \
  }
OPEN(open, (const char *path, int flags, ...), (path, flags, mode))
OPEN(open64, (const char *path, int flags, ...), (path, flags, mode))
OPEN(openat, (int at, const char *path, int flags, ...), (at, path, flags, mode))
OPEN(openat64, (int at, const char *path, int flags, ...), (at, path, flags, mode))

#define FOPEN(name) \
  FILE *name(const char *path, const char *how) { \
    REAL(name); \
    return how[0] != 'r' && access(path, F_OK) && fails_at(path) ? NULL : real(path, how); \
  }
FOPEN(fopen)
FOPEN(fopen64)

#define CHANGE(result, name, parameters, values, fails, failure) \
  result name parameters { \
    REAL(name); \
    return fails ? failure : real values; \
  }
CHANGE(ssize_t, write, (int file, const void *data, size_t size), (file, data, size), fails_in(file), -1)
CHANGE(ssize_t, pwrite, (int file, const void *data, size_t size, off_t at), (file, data, size, at), fails_in(file), -1)
CHANGE(ssize_t, pwrite64, (int file, const void *data, size_t size, off64_t at), (file, data, size, at), fails_in(file), -1)
CHANGE(ssize_t, writev, (int file, const struct iovec *pieces, int count), (file, pieces, count), fails_in(file), -1)
CHANGE(size_t, fwrite, (const void *data, size_t size, size_t count, FILE *file), (data, size, count, file),
       fails_in(fileno(file)), 0)
CHANGE(ssize_t, copy_file_range, (int from, off64_t *at, int to, off64_t *to_at, size_t size, unsigned flags),
       (from, at, to, to_at, size, flags), fails_in(to), -1)
CHANGE(int, fsync, (int file), (file), fails_in(file), -1)
CHANGE(int, fdatasync, (int file), (file), fails_in(file), -1)
CHANGE(int, rename, (const char *from, const char *to), (from, to), fails_at(to), -1)
CHANGE(int, link, (const char *from, const char *to), (from, to), fails_at(to), -1)
CHANGE(int, linkat, (int at, const char *from, int to_at, const char *to, int flags), (at, from, to_at, to, flags),
       fails_at(to), -1)
CHANGE(int, mkdir, (const char *path, mode_t mode), (path, mode), fails_at(path), -1)
