/* Makes calls of the system fail, for tests; loaded by LD_PRELOAD.
 *
 *   INJECT_FOLDER   only files whose path begins so
 *   INJECT_CALL     write, fsync, rename or open; or malloc, of any folder and from INJECT_BYTES on
 *   INJECT_AFTER    so many calls succeed before all others fail
 *   INJECT_ERRNO    how: 28 no space left, 5 input/output error, 13 permission denied ...
 *   INJECT_PART     a write that fails has written this part of its bytes before, 0 to 1
 *   INJECT_COUNT    a file that gets a byte for each call that was seen
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long calls;

static int ours(const char* path) {
  const char* folder = getenv("INJECT_FOLDER");
  return folder != NULL && path != NULL && strncmp(path, folder, strlen(folder)) == 0;
}

static int of_ours(int descriptor) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = '\0';
  return ours(path);
}

extern void* __libc_malloc(size_t);
extern void* __libc_memalign(size_t, size_t);

static ssize_t (*real_write(void))(int, const void*, size_t) {
  return (ssize_t(*)(int, const void*, size_t))dlsym(RTLD_NEXT, "write");
}

/* Whether this call is to fail; sets errno then. */
static int fails(const char* call) {
  const char *which = getenv("INJECT_CALL"), *after = getenv("INJECT_AFTER"), *how = getenv("INJECT_ERRNO");
  const char* count = getenv("INJECT_COUNT");
  if (which == NULL || strcmp(which, call) != 0) return 0;
  if (count != NULL) {
    int (*real_open)(const char*, int, ...) = (int (*)(const char*, int, ...))dlsym(RTLD_NEXT, "open");
    const int file = real_open(count, O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (file >= 0) {
      (void)!real_write()(file, "x", 1);
      close(file);
    }
  }
  if (after == NULL || atomic_fetch_add(&calls, 1) < atol(after)) return 0;
  errno = how != NULL ? atoi(how) : ENOSPC;
  return 1;
}

/* Whether an allocation of this size is to fail. Reading the environment allocates nothing. */
static int starved(size_t bytes) {
  const char* least = getenv("INJECT_BYTES");
  return least != NULL && bytes >= (size_t)atol(least) && fails("malloc");
}

void* malloc(size_t bytes) {
  if (!starved(bytes)) return __libc_malloc(bytes);
  errno = ENOMEM;
  return NULL;
}

void* aligned_alloc(size_t alignment, size_t bytes) {
  if (!starved(bytes)) return __libc_memalign(alignment, bytes);
  errno = ENOMEM;
  return NULL;
}

int posix_memalign(void** place, size_t alignment, size_t bytes) {
  if (starved(bytes)) return ENOMEM;
  *place = __libc_memalign(alignment, bytes);
  return *place != NULL ? 0 : ENOMEM;
}

ssize_t write(int descriptor, const void* text, size_t bytes) {
  if (of_ours(descriptor) && fails("write")) {
    const int reason = errno;
    const char* part = getenv("INJECT_PART");
    const size_t some = part != NULL ? (size_t)(atof(part) * bytes) : 0;
    if (some > 0) (void)!real_write()(descriptor, text, some);
    errno = reason;
    return -1;
  }
  return real_write()(descriptor, text, bytes);
}

int fsync(int descriptor) {
  if (of_ours(descriptor) && fails("fsync")) return -1;
  return ((int (*)(int))dlsym(RTLD_NEXT, "fsync"))(descriptor);
}

int rename(const char* from, const char* to) {
  if (ours(to) && fails("rename")) return -1;
  return ((int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename"))(from, to);
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if ((flags & O_CREAT) != 0 && ours(path) && fails("open")) return -1;
  return ((int (*)(const char*, int, ...))dlsym(RTLD_NEXT, "open"))(path, flags, mode);
}
