/* html.h - text of others into a page, safely. */
#ifndef HTML_H
#define HTML_H
#include <stddef.h>
#include <stdio.h>

/* Text, or the value of an attribute between double quotes. */
void html_text(FILE *page, const char *text);

/* printf whose %s arguments are all escaped; no other directive than %s is known. */
void html_put(FILE *page, const char *format, ...);

/* Base 64 (RFC 4648), for data: links. */
void html_base64(FILE *page, const void *bytes, size_t size);

/* An SVG file as an element of the page: without what stands before <svg, and with `name` before
 * each of its ids, which must be unique in a page. */
void html_svg(FILE *page, const char *svg, const char *name);

#endif
