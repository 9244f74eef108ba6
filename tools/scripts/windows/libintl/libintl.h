/* GPL-2.0-or-later. The functions of GNU libintl that GLib calls: its build asks for them even with -Dnls=disabled.
   They return the text that they are given, so every text stays English. */
#ifndef LIBINTL_H
#define LIBINTL_H

#include <locale.h>

/* The category of messages, a parameter of dcgettext: POSIX has it, the C library of Windows does not. Its value is not
   used. */
#ifndef LC_MESSAGES
#define LC_MESSAGES LC_CTYPE
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The translation of a text in the default or the given domain: the text itself. */
char *gettext(const char *text);
char *dgettext(const char *domain, const char *text);
char *dcgettext(const char *domain, const char *text, int category);
/* The English singular or plural form for that number of things. */
char *ngettext(const char *one, const char *many, unsigned long count);
char *dngettext(const char *domain, const char *one, const char *many, unsigned long count);
/* Choose a domain, its folder and its character set: no effect. They return the name that they are given. */
char *textdomain(const char *domain);
char *bindtextdomain(const char *domain, const char *folder);
char *bind_textdomain_codeset(const char *domain, const char *codeset);

#ifdef __cplusplus
}
#endif

#endif
