// GPL-2.0-or-later. Names of POSIX for files, which Microsoft's C library has under others.
#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#ifdef _MSC_VER
#include <io.h>

#define stat _stat64
#define fstat _fstat64
#define fileno _fileno
#define fseeko _fseeki64
#define off_t __int64
#define W_OK 2
#else
#include <unistd.h>
#endif
