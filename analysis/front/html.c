#include "html.h"

#include <stdarg.h>
#include <string.h>

void html_text(FILE *page, const char *text)
{
  for (const char *c = text ? text : ""; *c; c++) {
    const char *name = *c == '&' ? "&amp;" : *c == '<' ? "&lt;" : *c == '>' ? "&gt;" : NULL;
    if (*c == '"') name = "&quot;";
    if (*c == '\'') name = "&#39;";
    if (name)
      fputs(name, page);
    else if ((unsigned char)*c >= ' ' || *c == '\n')
      fputc(*c, page);
  }
}

void html_put(FILE *page, const char *format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  for (const char *c = format; *c; c++) {
    if (c[0] == '%' && c[1] == 's') {
      html_text(page, va_arg(arguments, const char *));
      c++;
    } else {
      fputc(*c, page);
    }
  }
  va_end(arguments);
}

void html_base64(FILE *page, const void *bytes, size_t size)
{
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const unsigned char *b = bytes;
  for (size_t k = 0; k < size; k += 3) {
    const size_t left = size - k;
    const unsigned three =
      (unsigned)b[k] << 16 | (left > 1 ? (unsigned)b[k + 1] << 8 : 0) | (left > 2 ? b[k + 2] : 0);
    fputc(digit[three >> 18], page);
    fputc(digit[three >> 12 & 63], page);
    fputc(left > 1 ? digit[three >> 6 & 63] : '=', page);
    fputc(left > 2 ? digit[three & 63] : '=', page);
  }
}

/* The lengths of the texts behind which an id follows. */
static size_t before_id(const char *c)
{
  static const char *const marks[] = {" id=\"", " id='", "href='#", "href=\"#", "url(#"};
  for (size_t k = 0; k < sizeof marks / sizeof *marks; k++)
    if (strncmp(c, marks[k], strlen(marks[k])) == 0) return strlen(marks[k]);
  return 0;
}

void html_svg(FILE *page, const char *svg, const char *name)
{
  const char *c = strstr(svg, "<svg");
  while (c && *c) {
    const size_t length = before_id(c);
    if (!length) {
      fputc(*c++, page);
      continue;
    }
    fwrite(c, 1, length, page);
    html_text(page, name);
    fputc('-', page);
    c += length;
  }
}
