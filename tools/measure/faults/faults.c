/* GPL-2.0-or-later. Preloaded into a program, it counts its calls of the C library by kind and makes one of them fail.
 *
 * Linux with glibc. tools/measure/fault_injection compiles it, sets these variables and reads the result:
 *
 *   FAULT_FILE    a file of at least sizeof(struct Record) bytes, which is mapped: it stays when the program dies
 *   FAULT_KIND    a word of kKindNames, or "any": which calls count
 *   FAULT_AT      number of the call at which something happens, from 1; 0: only counts
 *   FAULT_ERRNO   number of the error
 *   FAULT_ACTION  what happens: "fail" (this call), "fail-on" (this call and all later ones), "kill" (the program dies
 *                 by SIGKILL before the call), "remove:PATH" or "save:PATH" (another program removes the file, or
 *                 renames PATH.saved over it, before the call)
 *   FAULT_CLOCK   seconds by which each call puts the time of day further back
 *   FAULT_SERVER  "FROM TO OUTPUT": the program waits before main. For each byte that arrives at the descriptor FROM it
 *                 starts a child, which takes kind, number and action from the file and prints into the file OUTPUT.
 *                 Then it writes the child's id and its wait status to the descriptor TO. This saves the time of loading
 *                 libraries.
 *
 * Calls before main are not counted: a program without memory for its libraries does not start. Functions of the C
 * library call each other without the dynamic linker, so each function that the program or a library uses is here. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

/* ---- What the driver is told ---- */

enum Kind { kWrite, kFlush, kRename, kOpen, kRead, kStat, kAlloc, kThread, kMkdir, kRemove, kPrint, kSocket, kKinds };
static const char *const kKindNames[kKinds] = {"write", "flush",  "rename", "open",   "read",  "stat",
                                               "alloc", "thread", "mkdir",  "remove", "print", "socket"};

struct Record {
    long long wanted, at, number; /* with FAULT_SERVER: as the variables, the kind as a number */
    char action[4096];
    long long counts[16]; /* by kind; the last one: all kinds */
    long long happened;   /* how often a call failed, or something else happened */
    char call[64];        /* the function of the first time */
    char stack[8192];     /* its callers, "OBJECT+OFFSET SYMBOL" a line */
};

enum { kAny = 15 };

static struct Record *record;
static int wanted = -1; /* a kind, or kAny */
static long long at;
static int number = EIO;
static char action[4096] = "fail";
static long clockStep;
static int started;   /* main has been called */
static int recording; /* the first injection is writing its stack */

static void ReadVariables(void) {
    const char *file = getenv("FAULT_FILE"), *kind = getenv("FAULT_KIND"), *text;
    const int descriptor = file ? open(file, O_RDWR | O_CLOEXEC) : -1;
    if (descriptor < 0)
        return;
    void *const mapped = mmap(NULL, sizeof *record, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    close(descriptor);
    if (mapped == MAP_FAILED)
        return;
    for (int i = 0; kind && i < kKinds; ++i)
        if (strcmp(kind, kKindNames[i]) == 0)
            wanted = i;
    if (kind && strcmp(kind, "any") == 0)
        wanted = kAny;
    if ((text = getenv("FAULT_AT")) != NULL)
        at = atoll(text);
    if ((text = getenv("FAULT_ERRNO")) != NULL)
        number = atoi(text);
    if ((text = getenv("FAULT_ACTION")) != NULL)
        strncpy(action, text, sizeof action - 1);
    if ((text = getenv("FAULT_CLOCK")) != NULL)
        clockStep = atol(text);
    void *frames[2];
    backtrace(frames, 2); /* loads what it needs, now that memory is there */
    record = mapped;
}

/* Returns in each child. */
static void Serve(const char *server) {
    int from, to;
    char output[4096], byte;
    if (sscanf(server, "%d %d %4095s", &from, &to, output) != 3)
        _exit(127);
    while (read(from, &byte, 1) == 1) {
        const pid_t child = fork();
        if (child == 0) {
            close(from);
            close(to);
            const int printed = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0666);
            dup2(printed, STDOUT_FILENO);
            dup2(printed, STDERR_FILENO);
            close(printed);
            wanted = (int)record->wanted;
            at = record->at;
            number = (int)record->number;
            strcpy(action, record->action);
            return;
        }
        int result[2] = {child, 0};
        if (write(to, &result[0], sizeof result[0]) < 0)
            _exit(127);
        waitpid(child, &result[1], 0);
        if (write(to, &result[1], sizeof result[1]) < 0)
            _exit(127);
    }
    _exit(0);
}

/* ---- Whether a call fails ---- */

static void RecordStack(const char *call) {
    strncpy(record->call, call, sizeof record->call - 1);
    void *frames[40];
    const int count = backtrace(frames, 40);
    size_t used = 0;
    for (int i = 2; i < count && used + 300 < sizeof record->stack; ++i) {
        Dl_info info;
        if (dladdr(frames[i], &info) == 0 || info.dli_fname == NULL)
            continue;
        const char *const slash = strrchr(info.dli_fname, '/');
        const int length =
            snprintf(record->stack + used, 300, "%s+0x%lx %s\n", slash ? slash + 1 : info.dli_fname,
                     (unsigned long)((char *)frames[i] - (char *)info.dli_fbase), info.dli_sname ? info.dli_sname : "");
        used += length < 300 ? (size_t)length : 299;
    }
}

static void Act(void) {
    if (strcmp(action, "kill") == 0)
        syscall(SYS_kill, getpid(), SIGKILL);
    if (strncmp(action, "remove:", 7) == 0)
        syscall(SYS_unlink, action + 7);
    if (strncmp(action, "save:", 5) == 0) {
        char saved[sizeof action + 8];
        snprintf(saved, sizeof saved, "%s.saved", action + 5);
        syscall(SYS_rename, saved, action + 5);
    }
}

/* Counts a call. 1: it must fail; errno is set. */
static int Fails(enum Kind kind, const char *call) {
    if (record == NULL || !__atomic_load_n(&started, __ATOMIC_RELAXED) || __atomic_load_n(&recording, __ATOMIC_RELAXED))
        return 0;
    const long long count = __atomic_add_fetch(&record->counts[kind], 1, __ATOMIC_RELAXED);
    const long long all = kind == kPrint ? 0 : __atomic_add_fetch(&record->counts[kAny], 1, __ATOMIC_RELAXED);
    const long long mine = wanted == (int)kind ? count : wanted == kAny ? all : 0;
    const int lasts = strcmp(action, "fail-on") == 0;
    if (at == 0 || mine == 0 || (lasts ? mine < at : mine != at))
        return 0;
    const int before = errno;
    if (__atomic_add_fetch(&record->happened, 1, __ATOMIC_RELAXED) == 1) {
        __atomic_store_n(&recording, 1, __ATOMIC_RELAXED);
        RecordStack(call);
        __atomic_store_n(&recording, 0, __ATOMIC_RELAXED);
    }
    Act();
    const int fails = strncmp(action, "fail", 4) == 0;
    errno = fails ? number : before;
    return fails;
}

/* ---- The functions ---- */

#define NEXT(type, name, ...)                                                                                          \
    static type (*next)(__VA_ARGS__);                                                                                  \
    if (next == NULL)                                                                                                  \
    *(void **)&next = dlsym(RTLD_NEXT, #name)

/* A function of which each argument is passed on. */
#define FUNCTION(kind, type, name, failed, parameters, ...)                                                            \
    EXPORT type name parameters {                                                                                      \
        static type(*next) parameters;                                                                                 \
        if (next == NULL)                                                                                              \
            *(void **)&next = dlsym(RTLD_NEXT, #name);                                                                 \
        return Fails(kind, #name) ? failed : next(__VA_ARGS__);                                                        \
    }

static int IsPrinted(FILE *file) {
    return file == stdout || file == stderr;
}

static enum Kind KindOfFile(FILE *file) {
    return IsPrinted(file) ? kPrint : kWrite;
}

static enum Kind KindOfDescriptor(int descriptor) {
    return descriptor == STDOUT_FILENO || descriptor == STDERR_FILENO ? kPrint : kWrite;
}

/* Half of it is still written, as on a disk that becomes full. */
EXPORT size_t fwrite(const void *from, size_t size, size_t count, FILE *file) {
    NEXT(size_t, fwrite, const void *, size_t, size_t, FILE *);
    if (Fails(KindOfFile(file), "fwrite")) {
        const int failed = errno;
        const size_t written = next(from, size, count / 2, file);
        errno = failed;
        return written;
    }
    return next(from, size, count, file);
}

FUNCTION(KindOfFile(file), int, fputs, EOF, (const char *text, FILE *file), text, file)
FUNCTION(KindOfFile(file), int, fputc, EOF, (int c, FILE *file), c, file)
FUNCTION(KindOfFile(file), int, putc, EOF, (int c, FILE *file), c, file)
FUNCTION(KindOfFile(file), int, vfprintf, -1, (FILE * file, const char *format, va_list list), file, format, list)
FUNCTION(KindOfDescriptor(to), ssize_t, write, -1, (int to, const void *from, size_t size), to, from, size)
FUNCTION(KindOfDescriptor(to), ssize_t, writev, -1, (int to, const struct iovec *from, int count), to, from, count)
FUNCTION(kWrite, ssize_t, pwrite, -1, (int to, const void *from, size_t size, off_t at_), to, from, size, at_)
FUNCTION(kWrite, ssize_t, pwrite64, -1, (int to, const void *from, size_t size, off64_t at_), to, from, size, at_)
FUNCTION(kWrite, int, ftruncate, -1, (int file, off_t size), file, size)
FUNCTION(kWrite, int, ftruncate64, -1, (int file, off64_t size), file, size)

FUNCTION(file == NULL || IsPrinted(file) ? kPrint : kFlush, int, fflush, EOF, (FILE * file), file)
FUNCTION(kFlush, int, fsync, -1, (int file), file)
FUNCTION(kFlush, int, fdatasync, -1, (int file), file)

/* The file is closed all the same. */
EXPORT int fclose(FILE *file) {
    NEXT(int, fclose, FILE *);
    const int fails = Fails(kFlush, "fclose"), failed = errno;
    const int result = next(file);
    if (fails)
        errno = failed;
    return fails ? EOF : result;
}

FUNCTION(kRename, int, rename, -1, (const char *from, const char *to), from, to)
FUNCTION(kRename, int, renameat, -1, (int a, const char *from, int b, const char *to), a, from, b, to)
FUNCTION(kRename, int, renameat2, -1, (int a, const char *from, int b, const char *to, unsigned flags), a, from, b, to,
         flags)
FUNCTION(kRename, int, link, -1, (const char *from, const char *to), from, to)
FUNCTION(kRename, int, symlink, -1, (const char *from, const char *to), from, to)

FUNCTION(kOpen, FILE *, fopen, NULL, (const char *path, const char *mode), path, mode)
FUNCTION(kOpen, FILE *, fopen64, NULL, (const char *path, const char *mode), path, mode)
FUNCTION(kOpen, FILE *, fdopen, NULL, (int file, const char *mode), file, mode)
FUNCTION(kOpen, DIR *, opendir, NULL, (const char *path), path)
FUNCTION(kOpen, DIR *, fdopendir, NULL, (int file), file)
FUNCTION(kOpen, int, mkstemp, -1, (char *name), name)
FUNCTION(kOpen, int, mkostemp, -1, (char *name, int flags), name, flags)
FUNCTION(kOpen, int, flock, -1, (int file, int how), file, how)

#define OPEN(name, first, firstName)                                                                                   \
    EXPORT int name(first const char *path, int flags, ...) {                                                          \
        static int (*next)(first const char *, int, ...);                                                              \
        if (next == NULL)                                                                                              \
            *(void **)&next = dlsym(RTLD_NEXT, #name);                                                                 \
        va_list list;                                                                                                  \
        va_start(list, flags);                                                                                         \
        const int mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(list, int) : 0;                                      \
        va_end(list);                                                                                                  \
        return Fails(kOpen, #name) ? -1 : next(firstName path, flags, mode);                                           \
    }
#define NONE
#define FOLDER int folder,
#define FOLDER_NAME folder,
OPEN(open, NONE, NONE)
OPEN(open64, NONE, NONE)
OPEN(openat, FOLDER, FOLDER_NAME)
OPEN(openat64, FOLDER, FOLDER_NAME)

FUNCTION(kRead, size_t, fread, 0, (void *into, size_t size, size_t count, FILE *file), into, size, count, file)
FUNCTION(kRead, char *, fgets, NULL, (char *into, int size, FILE *file), into, size, file)
FUNCTION(kRead, int, fseek, -1, (FILE * file, long to, int from), file, to, from)
FUNCTION(kRead, int, fseeko, -1, (FILE * file, off_t to, int from), file, to, from)
FUNCTION(kRead, int, fseeko64, -1, (FILE * file, off64_t to, int from), file, to, from)
FUNCTION(kRead, ssize_t, read, -1, (int file, void *into, size_t size), file, into, size)
FUNCTION(kRead, ssize_t, readv, -1, (int file, const struct iovec *into, int count), file, into, count)
FUNCTION(kRead, ssize_t, pread, -1, (int file, void *into, size_t size, off_t from), file, into, size, from)
FUNCTION(kRead, ssize_t, pread64, -1, (int file, void *into, size_t size, off64_t from), file, into, size, from)
FUNCTION(kRead, struct dirent *, readdir, NULL, (DIR * folder), folder)
FUNCTION(kRead, struct dirent64 *, readdir64, NULL, (DIR * folder), folder)

FUNCTION(kStat, int, stat, -1, (const char *path, struct stat *info), path, info)
FUNCTION(kStat, int, stat64, -1, (const char *path, struct stat64 *info), path, info)
FUNCTION(kStat, int, lstat, -1, (const char *path, struct stat *info), path, info)
FUNCTION(kStat, int, lstat64, -1, (const char *path, struct stat64 *info), path, info)
FUNCTION(kStat, int, fstat, -1, (int file, struct stat *info), file, info)
FUNCTION(kStat, int, fstat64, -1, (int file, struct stat64 *info), file, info)
FUNCTION(kStat, int, fstatat, -1, (int folder, const char *path, struct stat *info, int flags), folder, path, info,
         flags)
FUNCTION(kStat, int, access, -1, (const char *path, int mode), path, mode)
FUNCTION(kStat, ssize_t, readlink, -1, (const char *path, char *into, size_t size), path, into, size)

FUNCTION(kMkdir, int, mkdir, -1, (const char *path, mode_t mode), path, mode)
FUNCTION(kMkdir, int, mkdirat, -1, (int folder, const char *path, mode_t mode), folder, path, mode)

FUNCTION(kRemove, int, unlink, -1, (const char *path), path)
FUNCTION(kRemove, int, unlinkat, -1, (int folder, const char *path, int flags), folder, path, flags)
FUNCTION(kRemove, int, remove, -1, (const char *path), path)
FUNCTION(kRemove, int, rmdir, -1, (const char *path), path)

FUNCTION(kSocket, int, socket, -1, (int family, int type, int protocol), family, type, protocol)
FUNCTION(kSocket, int, connect, -1, (int file, const struct sockaddr *to, socklen_t size), file, to, size)
FUNCTION(kSocket, ssize_t, send, -1, (int file, const void *from, size_t size, int flags), file, from, size, flags)

EXPORT int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument) {
    NEXT(int, pthread_create, pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
    return Fails(kThread, "pthread_create") ? number : next(thread, attributes, start, argument);
}

/* ---- Memory. dlsym may ask for some itself, so these have other names in the C library. ---- */

void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);
void *__libc_memalign(size_t, size_t);

EXPORT void *malloc(size_t size) {
    return Fails(kAlloc, "malloc") ? NULL : __libc_malloc(size);
}

EXPORT void *calloc(size_t count, size_t size) {
    return Fails(kAlloc, "calloc") ? NULL : __libc_calloc(count, size);
}

EXPORT void *realloc(void *block, size_t size) {
    return Fails(kAlloc, "realloc") ? NULL : __libc_realloc(block, size);
}

EXPORT void *reallocarray(void *block, size_t count, size_t size) {
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes)) {
        errno = ENOMEM;
        return NULL;
    }
    return realloc(block, bytes);
}

EXPORT void *memalign(size_t alignment, size_t size) {
    return Fails(kAlloc, "memalign") ? NULL : __libc_memalign(alignment, size);
}

EXPORT void *aligned_alloc(size_t alignment, size_t size) {
    return Fails(kAlloc, "aligned_alloc") ? NULL : __libc_memalign(alignment, size);
}

EXPORT int posix_memalign(void **block, size_t alignment, size_t size) {
    void *const got = Fails(kAlloc, "posix_memalign") ? NULL : __libc_memalign(alignment, size);
    if (got == NULL)
        return ENOMEM;
    *block = got;
    return 0;
}

/* Mapped files are read; other mappings are memory. */
EXPORT void *mmap(void *where, size_t size, int protection, int flags, int file, off_t from) {
    if (Fails(flags & MAP_ANONYMOUS ? kAlloc : kRead, "mmap"))
        return MAP_FAILED;
    return (void *)syscall(SYS_mmap, where, size, protection, flags, file, from);
}

EXPORT void *mmap64(void *where, size_t size, int protection, int flags, int file, off64_t from) {
    return mmap(where, size, protection, flags, file, from);
}

/* ---- The end ---- */

/* Where the program gives up tells more than which call failed. */
EXPORT void abort(void) {
    void (*next)(void);
    *(void **)&next = dlsym(RTLD_NEXT, "abort");
    if (record != NULL && record->happened > 0)
        RecordStack("abort");
    next();
    __builtin_unreachable();
}

/* ---- The time of day ---- */

static long long SecondsBack(void) {
    static long long calls;
    return clockStep * __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED);
}

EXPORT int clock_gettime(clockid_t clock, struct timespec *now) {
    const int result = (int)syscall(SYS_clock_gettime, clock, now);
    if (clockStep != 0 && clock == CLOCK_REALTIME)
        now->tv_sec -= SecondsBack();
    return result;
}

EXPORT time_t time(time_t *into) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (into)
        *into = now.tv_sec;
    return now.tv_sec;
}

EXPORT int gettimeofday(struct timeval *restrict now, void *restrict zone) {
    struct timespec exact;
    (void)zone;
    clock_gettime(CLOCK_REALTIME, &exact);
    now->tv_sec = exact.tv_sec;
    now->tv_usec = exact.tv_nsec / 1000;
    return 0;
}

/* ---- Start ---- */

static int (*theirMain)(int, char **, char **);

static int CountedMain(int count, char **words, char **environment) {
    ReadVariables();
    if (record != NULL && getenv("FAULT_SERVER") != NULL)
        Serve(getenv("FAULT_SERVER"));
    __atomic_store_n(&started, 1, __ATOMIC_RELEASE);
    return theirMain(count, words, environment);
}

EXPORT int __libc_start_main(int (*main)(int, char **, char **), int count, char **words, void (*init)(void),
                             void (*fini)(void), void (*end)(void), void *stack) {
    int (*next)(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void), void (*)(void), void *);
    *(void **)&next = dlsym(RTLD_NEXT, "__libc_start_main");
    theirMain = main;
    return next(CountedMain, count, words, init, fini, end, stack);
}
