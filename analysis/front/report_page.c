/* The frame of the report: style for light and dark, wide and narrow; a script that sorts tables.
 */
#include "html.h"
#include "report.h"

#define LIGHT                                                                       \
  "color-scheme:light;--back:#fbfbfa;--text:#1c1e21;--soft:#5c636b;--line:#d9dce0;" \
  "--card:#fff;--link:#0b5cad;--bad:#a3290f;--good:#1f6f3a"
#define DARK                                                                       \
  "color-scheme:dark;--back:#15181b;--text:#e4e6e8;--soft:#a0a7ae;--line:#363c42;" \
  "--card:#1d2125;--link:#7db8f5;--bad:#ff9b82;--good:#7fd19b"

/* As the system has it, or as the switch says. */
static const char style[] =
  ":root{" LIGHT "}\n"
  "@media(prefers-color-scheme:dark){:root{" DARK "}}\n"
  ":root[data-theme=light]{" LIGHT "}:root[data-theme=dark]{" DARK "}\n"
  "body{margin:0 auto;max-width:76rem;padding:1rem 1.25rem 4rem;background:var(--back);"
  "color:var(--text);font:16px/1.5 system-ui,-apple-system,'Segoe UI','DejaVu Sans',sans-serif}\n"
  "h1{font-size:1.6rem;margin:.5rem 0}h2{margin:2.5rem 0 .75rem;font-size:1.3rem;"
  "border-bottom:1px solid var(--line);padding-bottom:.25rem}\n"
  "h3{font-size:1.05rem;margin:0 0 .5rem}\n"
  "nav a{margin-right:1rem;white-space:nowrap;display:inline-block}a{color:var(--link)}"
  "p{margin:.5rem 0;max-width:50rem}\n"
  "button{font:inherit;color:var(--text);background:var(--card);cursor:pointer;"
  "border:1px solid var(--line);border-radius:6px;padding:.1rem .6rem}"
  "#theme{float:right;margin-top:.5rem}.csv{font-size:.8125rem;margin:-.5rem 0 1rem}\n"
  "figure{margin:0 0 2.5rem}figcaption{max-width:50rem;margin-top:.5rem}\n"
  /* pictures are drawn on paper, in the dark as well: their colours are those of the legend */
  ".paper{background:#fff;border:1px solid var(--line);border-radius:6px;padding:.5rem;"
  "text-align:center}.paper svg{max-width:100%;height:auto}\n"
  ".paper img{max-width:100%;height:auto}.paper{overflow-x:auto;color:#000}\n"
  ".paper svg text{font-family:system-ui,-apple-system,'Segoe UI','DejaVu Sans',sans-serif}\n"
  ".origin{color:var(--soft);font-size:.875rem}.origin span{margin-left:1rem}\n"
  "code{font:.875em ui-monospace,'DejaVu Sans Mono',monospace;overflow-wrap:anywhere}\n"
  ".scroll{overflow-x:auto;border:1px solid var(--line);border-radius:6px;margin:.5rem 0 1rem}\n"
  "table{border-collapse:separate;border-spacing:0;"
  "font-size:.8125rem;background:var(--card);min-width:100%;"
  "font-variant-numeric:tabular-nums}th,td{padding:.35rem .6rem;text-align:right;"
  "border-bottom:1px solid var(--line);white-space:nowrap}tbody tr:last-child>*{border-bottom:0}\n"
  "th{vertical-align:bottom;font-weight:600}th small{display:block;color:var(--soft);"
  "font-weight:400}.words th,.words td,th:first-child,td:first-child{text-align:left}\n"
  "td code{display:block;text-align:left}"
  ".words td{white-space:normal;min-width:8rem;vertical-align:top}\n"
  "th:first-child,td:first-child{position:sticky;left:0;background:var(--card)}\n"
  "th button{font-weight:600;background:none;border:0;padding:0;text-align:inherit}"
  "th[aria-sort=ascending] button::after{content:' \\25B2'}"
  "th[aria-sort=descending] button::after{content:' \\25BC'}"
  ":focus-visible{outline:2px solid var(--link);outline-offset:2px}\n"
  ".bad{color:var(--bad)}.good{color:var(--good)}.gap,.soft{color:var(--soft)}\n"
  /* reason and command may be long */
  ".runs td{white-space:nowrap;min-width:0}.runs td:nth-child(n+7){white-space:normal;"
  "min-width:18rem}summary{cursor:pointer}details>.scroll{max-height:70vh}\n"
  /* a figure is read by moving it sideways, not by a glass */
  "@media(max-width:40rem){body{padding:.5rem .75rem 3rem}.origin span{display:block;margin:0}"
  ".paper svg,.paper img{max-width:none;width:42rem}}\n"
  "@media print{button{display:none}.scroll{overflow:visible}}\n";

/* Without it the page shows all the same: as the system's theme, and in the order of the file. */
static const char script[] =
  "const root=document.documentElement,toggle=document.getElementById('theme');\n"
  "const kept=(f)=>{try{return f(localStorage)}catch(e){}};\n"
  "const dark=()=>root.dataset.theme?root.dataset.theme==='dark':\n"
  "  matchMedia('(prefers-color-scheme:dark)').matches;\n"
  "const name=()=>toggle.textContent=dark()?'Light':'Dark';\n"
  "const was=kept(s=>s.getItem('sphbench-theme'));if(was)root.dataset.theme=was;\n"
  "toggle.onclick=()=>{root.dataset.theme=dark()?'light':'dark';name();\n"
  "  kept(s=>s.setItem('sphbench-theme',root.dataset.theme))};\n"
  "toggle.hidden=false;name();\n"
  "const text=c=>c.textContent.trim(),none=t=>t===''||t==='-'||t==='\\u2013';\n"
  "const order=(a,b)=>{const x=parseFloat(a),y=parseFloat(b);\n"
  "  return isNaN(x)||isNaN(y)?(isNaN(x)-isNaN(y))||a.localeCompare(b):x-y};\n"
  "const sort=th=>{const k=th.cellIndex,body=th.closest('table').tBodies[0];\n"
  "  const up=th.getAttribute('aria-sort')!=='ascending';\n"
  "  [...body.rows].sort((r,s)=>{const a=text(r.cells[k]),b=text(s.cells[k]);\n"
  "    return none(a)-none(b)||(up?1:-1)*order(a,b)}).forEach(r=>body.append(r));\n"
  "  th.parentNode.querySelectorAll('th').forEach(o=>o.removeAttribute('aria-sort'));\n"
  "  th.setAttribute('aria-sort',up?'ascending':'descending')};\n"
  "document.querySelectorAll('table.sortable thead th').forEach(th=>{\n"
  "  const b=document.createElement('button');b.type='button';b.append(...th.childNodes);\n"
  "  b.onclick=()=>sort(th);th.append(b)});\n"
  "const field=c=>'\"'+text(c).replaceAll('\"','\"\"')+'\"';\n"
  "document.querySelectorAll('.scroll').forEach((box,k)=>{\n"
  "  const b=document.createElement('button'),t=box.querySelector('table');\n"
  "  box.tabIndex=0;b.type='button';b.className='csv';b.textContent='This table as CSV';\n"
  "  b.onclick=()=>{const a=document.createElement('a');a.download='table-'+(k+1)+'.csv';\n"
  "    a.href='data:text/csv;charset=utf-8,'+encodeURIComponent(\n"
  "      [...t.rows].map(r=>[...r.cells].map(field).join(',')).join('\\n')+'\\n');a.click()};\n"
  "  box.after(b)});\n";

static int any_figure(const struct report *r, enum figure_sort sort)
{
  for (int k = 0; k < r->num_figures; k++)
    if (figure_sort_of(&r->figure[k]) == sort) return 1;
  return 0;
}

/* Only to what is there. */
static void put_contents(FILE *page, const struct report *r)
{
  fputs("<nav>", page);
  if (any_figure(r, SORT_MEASURED)) fputs("<a href=#precision>Error against cost</a>", page);
  if (any_figure(r, SORT_FRAMES)) fputs("<a href=#gallery>Gallery</a>", page);
  fputs("<a href=#metrics>Metrics</a>", page);
  if (any_figure(r, SORT_CURVES)) fputs("<a href=#figures>Figures</a>", page);
  fputs("<a href=#compatibility>Not run or failed</a><a href=#runs>Every run</a>"
        "<a href=#origin>Origin</a></nav>\n",
        page);
}

void page_begin(FILE *page, const struct report *report)
{
  fputs("<!doctype html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n"
        "<meta name=viewport content=\"width=device-width,initial-scale=1\">\n"
        "<title>SPH pressure solvers compared</title>\n<style>\n",
        page);
  fputs(style, page);
  fputs("</style>\n</head>\n<body>\n<button id=theme type=button hidden></button>\n"
        "<h1>SPH pressure solvers compared</h1>\n",
        page);
  fprintf(page,
          "<p>%d runs, %d figures. Every number comes from the result files of these runs; "
          "every solver has the same colour and mark in all figures.</p>\n",
          report->num_runs, report->num_figures);
  put_contents(page, report);
}

void page_end(FILE *page)
{
  fputs("<script>\n", page);
  fputs(script, page);
  fputs("</script>\n</body>\n</html>\n", page);
}
