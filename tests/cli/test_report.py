#!/usr/bin/python3
"""The page of `sphbench report`: what it says, and, where Chromium is installed, how it behaves."""
import base64
import html
import json
import re
import shutil
import subprocess
import unittest

import cli_case
from cli_case import Case

PLAN = """name: page
about: one run that ends, and one that a solver refuses
runs:
  - {scene: two-particle, solvers: [dfsph, wcsph], t_end: 0.01, set: [samples=4]}
  - {scene: first-step, solvers: [pbf], spacing: 0.02}
"""
SVG = ("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 900 300' width='900' height='300'>"
       "<text id='a' x='9' y='20'>gap</text></svg>")
# Runs in the page: what a user would do, and what is seen.
PROBE = """<script>
addEventListener('error', e => seen.errors.push(e.message));
const seen = {errors: [], width: innerWidth, scroll: document.documentElement.scrollWidth};
const table = document.querySelector('table.probe'), heads = table.querySelectorAll('th button');
const column = k => [...table.tBodies[0].rows].map(row => row.cells[k].textContent);
const click = k => { heads[k].click(); return column(k); };
seen.numbers = [click(0), click(0)];
seen.words = [click(1), click(1)];
seen.sorted = [...table.querySelectorAll('th')].map(th => th.getAttribute('aria-sort'));
seen.keyboard = [...heads].every(b => b.tagName === 'BUTTON' && b.tabIndex === 0);
HTMLAnchorElement.prototype.click = function () { seen.csv = decodeURIComponent(this.href); };
table.closest('.scroll').nextElementSibling.click();
const back = () => getComputedStyle(document.body).backgroundColor;
const theme = document.getElementById('theme');
const paper = () => getComputedStyle(document.querySelector('.paper')).backgroundColor;
seen.backs = [back()]; seen.papers = [paper()]; theme.click();
seen.backs.push(back()); seen.papers.push(paper()); theme.click(); seen.backs.push(back());
(parent === window ? document.body : {setAttribute: (k, v) => parent.postMessage(v, '*')})
  .setAttribute('data-seen', JSON.stringify(seen));
</script></body>"""
TABLE = """<div class=scroll><table class='sortable probe'><thead><tr><th>n</th><th>w</th></tr>
</thead><tbody><tr><td>10</td><td>b</td></tr><tr><td>\N{EN DASH}</td><td>\N{EN DASH}</td></tr>
<tr><td>9.5</td><td>a "1"</td></tr><tr><td>-2e3</td><td>C</td></tr></tbody></table></div>
<script>"""
PHONE = """<!doctype html><body style="margin:0"><script>
onmessage = e => document.body.setAttribute('data-seen', e.data);
</script><iframe src="probe.html" style="border:0;width:390px;height:844px"></iframe></body>"""


class Report(Case):
    def setUp(self):
        super().setUp()
        (self.dir / "p.yaml").write_text(PLAN)
        self.call("sweep", "p.yaml", "--results", "r", "--quiet", code=None)
        runs = [json.loads(line)["id"] for line in
                (self.dir / "r/journal.jsonl").read_text().splitlines()]
        self.done = [run for run in runs if (self.dir / f"r/runs/{run}.json").exists()]
        folder = self.dir / "r/figures/gap"
        folder.mkdir(parents=True)
        (folder / "a.dat").write_text("# a\n0 1.5\n1 2.5\n")
        (folder / "figure.json").write_text(json.dumps({
            "name": "gap", "about": "A <gap>", "statement": "It & grows", "order": 1,
            "kind": "series", "runs": self.done,
            "files": [{"file": "a.dat", "series": "a, b", "columns": ["t [s]", "d [m]"]}]}))
        (self.dir / "r/figures/gap.svg").write_text(SVG)
        self.call("report", "r", "-o", "page.html")
        self.page = (self.dir / "page.html").read_text()

    def call(self, *words, code=0, **more):
        if code is not None:
            return super().call(*words, code=code, **more)
        with self.start(*words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            return process.wait(cli_case.LONGEST)

    def test_what_it_says(self):
        self.assertEqual(len(self.done), 2)
        rows = re.findall(r"<tr><td>(two-particle|first-step)</td><td>([\w-]+)</td>"
                          r"<td class=(\w+)>(\w+)</td>(.*?)</tr>", self.page)
        states = {(scene, solver): word for scene, solver, _, word, _ in rows}
        self.assertEqual(states, {("two-particle", "dfsph"): "ok", ("two-particle", "wcsph"): "ok",
                                  ("first-step", "pbf"): "skipped"})
        for scene, solver, _, word, rest in rows:
            self.assertIn(f"<code>sphbench run {scene} --solver {solver} ", rest)
            self.assertEqual("cannot project velocities" in rest, word == "skipped")

    def test_a_figure(self):
        self.assertIn("<code>sphbench figure gap</code>", self.page)
        self.assertIn("A &lt;gap&gt;", self.page)
        self.assertRegex(self.page, r"From 2 runs, commit [0-9a-f]{6,10}")
        data = re.search(r'href="data:text/csv;base64,([^"]+)"', self.page).group(1)
        self.assertEqual(base64.b64decode(data).decode(),
                         'series,t [s],d [m]\n"a, b",0,1.5\n"a, b",1,2.5\n')
        self.assertIn("<svg", self.page)
        self.assertEqual(re.findall(r'(?:src|href)=(?!["\']?(?:#|data:))[^ >]+', self.page), [])

    def test_contents_lead_somewhere(self):
        for anchor in re.findall(r"<a href=#(\w+)>", self.page):
            self.assertRegex(self.page, f"id={anchor}>")
        self.assertNotIn("href=#gallery", self.page)  # there are no frames


@unittest.skipUnless(shutil.which("chromium"), "chromium is not installed")
class Browser(Report):
    test_what_it_says = test_a_figure = test_contents_lead_somewhere = None

    def look(self, name, size):
        command = ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu",
                   f"--user-data-dir={self.dir}/chromium", f"--window-size={size}",
                   "--virtual-time-budget=4000", "--enable-logging=stderr", "--dump-dom",
                   f"file://{self.dir}/{name}"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=cli_case.LONGEST,
                              check=False)
        self.assertNotRegex(done.stderr, r"CONSOLE.*(rror|ncaught)")
        found = re.search(r'data-seen="([^"]*)"', done.stdout)
        self.assertIsNotNone(found, f"the probe did not end: {done.stderr[-500:]}")
        return json.loads(html.unescape(found.group(1)))

    def test_it(self):
        page = self.page.replace("<script>", TABLE, 1).replace("</body>", PROBE)
        (self.dir / "probe.html").write_text(page)
        (self.dir / "phone.html").write_text(PHONE)
        for name, size, width in (("probe", "1400,1000", 1400), ("phone", "800,900", 390)):
            with self.subTest(width=width):
                self.check(self.look(f"{name}.html", size), width)

    def check(self, seen, width):
        dash = "\N{EN DASH}"
        self.assertEqual(seen["errors"], [])
        self.assertEqual(seen["width"], width)
        self.assertLessEqual(seen["scroll"], width)
        self.assertEqual(seen["numbers"], [["-2e3", "9.5", "10", dash],
                                           ["10", "9.5", "-2e3", dash]])
        self.assertEqual(seen["words"], [['a "1"', "b", "C", dash], ["C", "b", 'a "1"', dash]])
        self.assertEqual(seen["sorted"], [None, "descending"])
        self.assertTrue(seen["keyboard"])
        self.assertEqual(seen["csv"].split(",", 1)[1],
                         f'"n","w"\n"-2e3","C"\n"10","b"\n"9.5","a ""1"""\n"{dash}","{dash}"\n')
        self.assertNotEqual(seen["backs"][0], seen["backs"][1])
        self.assertEqual(seen["backs"][0], seen["backs"][2])
        self.assertEqual(seen["papers"], ["rgb(255, 255, 255)"] * 2)  # pictures are for paper


if __name__ == "__main__":
    cli_case.main()
