/* The frame of the report: style for light and dark, wide and narrow; a script that sorts tables.
 */
#include "html.h"
#include "report.h"

static const char style[] =
  ":root{color-scheme:light dark;--back:#fbfbfa;--text:#1c1e21;--soft:#5c636b;--line:#d9dce0;"
  "--card:#fff;--link:#0b5cad;--bad:#a3290f;--good:#1f6f3a}\n"
  "@media(prefers-color-scheme:dark){:root{--back:#15181b;--text:#e4e6e8;--soft:#a0a7ae;"
  "--line:#363c42;--card:#1d2125;--link:#7db8f5;--bad:#ff9b82;--good:#7fd19b}}\n"
  "body{margin:0 auto;max-width:76rem;padding:1rem 1.25rem 4rem;background:var(--back);"
  "color:var(--text);font:16px/1.5 system-ui,-apple-system,'Segoe UI','DejaVu Sans',sans-serif}\n"
  "h1{font-size:1.6rem;margin:.5rem 0}h2{margin:2.5rem 0 .75rem;font-size:1.3rem;"
  "border-bottom:1px solid var(--line);padding-bottom:.25rem}\n"
  "h3{font-size:1.05rem;margin:0 0 .5rem}\n"
  "nav a{margin-right:1rem}a{color:var(--link)}p{margin:.5rem 0;max-width:50rem}\n"
  "figure{margin:0 0 2.5rem}figcaption{max-width:50rem;margin-top:.5rem}\n"
  /* pictures are drawn on paper, in the dark as well: their colours are those of the legend */
  ".paper{background:#fff;border:1px solid var(--line);border-radius:6px;padding:.5rem;"
  "text-align:center}.paper svg{max-width:100%;height:auto}\n"
  ".paper img{max-width:100%;height:auto}\n"
  ".paper svg text{font-family:system-ui,-apple-system,'Segoe UI','DejaVu Sans',sans-serif}\n"
  ".origin{color:var(--soft);font-size:.875rem}.origin span{margin-left:1rem}\n"
  "code{font:.875em ui-monospace,'DejaVu Sans Mono',monospace;overflow-wrap:anywhere}\n"
  ".scroll{overflow-x:auto;border:1px solid var(--line);border-radius:6px;margin:.5rem 0 1rem}\n"
  "table{border-collapse:collapse;font-size:.8125rem;background:var(--card);min-width:100%;"
  "font-variant-numeric:tabular-nums}th,td{padding:.35rem .6rem;text-align:right;"
  "border-bottom:1px solid var(--line);white-space:nowrap}tbody tr:last-child>*{border-bottom:0}\n"
  "th{vertical-align:bottom;font-weight:600}th small{display:block;color:var(--soft);"
  "font-weight:400}.words th,.words td,th:first-child,td:first-child{text-align:left}\n"
  "td code{display:block;text-align:left}"
  ".words td{white-space:normal;min-width:8rem;vertical-align:top}\n"
  "th:first-child,td:first-child{position:sticky;left:0;background:var(--card)}\n"
  ".sortable th{cursor:pointer}th[aria-sort=ascending]::after{content:' \\25B2'}"
  "th[aria-sort=descending]::after{content:' \\25BC'}\n"
  ".bad{color:var(--bad)}.good{color:var(--good)}.gap,.soft{color:var(--soft)}\n"
  "@media(max-width:40rem){body{padding:.5rem .75rem 3rem}.origin span{display:block;margin:0}}\n";

static const char script[] =
  "document.querySelectorAll('table.sortable th').forEach(th=>{\n"
  "  const sort=()=>{\n"
  "    const k=th.cellIndex,body=th.closest('table').tBodies[0];\n"
  "    const up=th.getAttribute('aria-sort')!=='ascending';\n"
  "    const key=r=>{const t=r.cells[k].textContent.trim(),x=parseFloat(t);\n"
  "      return isNaN(x)?(t==='-'||t==='\\u2013'?Infinity:t):x};\n"
  "    const less=(a,b)=>typeof a===typeof b?(a<b?-1:a>b?1:0):typeof a==='number'?-1:1;\n"
  "    [...body.rows].sort((a,b)=>(up?1:-1)*less(key(a),key(b))).forEach(r=>body.append(r));\n"
  "    th.parentNode.querySelectorAll('th').forEach(o=>o.removeAttribute('aria-sort'));\n"
  "    th.setAttribute('aria-sort',up?'ascending':'descending')};\n"
  "  th.tabIndex=0;th.onclick=sort;th.onkeydown=e=>{if(e.key==='Enter')sort()}});\n";

void page_begin(FILE *page, const struct report *report)
{
  fputs("<!doctype html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n"
        "<meta name=viewport content=\"width=device-width,initial-scale=1\">\n"
        "<title>SPH pressure solvers compared</title>\n<style>\n",
        page);
  fputs(style, page);
  fputs("</style>\n</head>\n<body>\n<h1>SPH pressure solvers compared</h1>\n", page);
  fprintf(page,
          "<p>%d runs, %d figures. Every number comes from the result files of these runs; "
          "every solver has the same colour and mark in all figures.</p>\n",
          report->num_runs, report->num_figures);
  fputs("<nav><a href=#precision>Error against cost</a><a href=#gallery>Gallery</a>"
        "<a href=#metrics>Metrics</a><a href=#figures>Figures</a>"
        "<a href=#compatibility>Not run or failed</a><a href=#origin>Origin</a></nav>\n",
        page);
}

void page_end(FILE *page)
{
  fputs("<script>\n", page);
  fputs(script, page);
  fputs("</script>\n</body>\n</html>\n", page);
}
