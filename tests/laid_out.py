"""Whether a page can be read: what sticks out of its box, what is cut, what is too small."""

from __future__ import annotations

SMALLEST = 9.0  # of any letters [px]
WIDTHS = (390, 1280)  # of a telephone, and of a screen [px]
PAPER = 718  # of A4 between its margins [px]

FAULTS = """
(smallest) => {
  const faults = [], wide = document.documentElement.clientWidth;
  const printed = matchMedia("print").matches;
  const named = e => `<${e.tagName.toLowerCase()}> ${(e.textContent || "").trim().slice(0, 40)}`;
  const scrolls = e => ["auto", "scroll"].includes(getComputedStyle(e).overflowX);
  const room = e => (!e || scrolls(e) ? e : room(e.parentElement));
  if (document.documentElement.scrollWidth > wide) faults.push("the page scrolls sideways");
  for (const e of document.body.querySelectorAll("*")) {
    const style = getComputedStyle(e), box = e.getBoundingClientRect();
    if (!box.width || style.visibility === "hidden") continue;
    const around = room(e);
    if (around && printed && around.scrollWidth > around.clientWidth + 1)
      faults.push(`cut on paper: ${named(around)}`);
    const left = around ? around.getBoundingClientRect().left - around.scrollLeft : 0;
    const right = left + (around ? around.scrollWidth : wide);
    if (box.right > right + 1 || box.left < -1) faults.push(`sticks out: ${named(e)}`);
    const own = [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim());
    if (!own) continue;
    const matrix = e.ownerSVGElement && e.getScreenCTM();
    const scale = matrix ? Math.hypot(matrix.a, matrix.b) : 1;
    const size = parseFloat(style.fontSize) * scale;
    if (size < smallest - 0.05) faults.push(`${size.toFixed(1)} px: ${named(e)}`);
  }
  return [...new Set(faults)];
}
"""


def faults(browser, address, *, picture=None):
    """What is wrong with a page at each width, in light and dark, and on paper: by where it is."""
    found = {}
    for colours in ("light", "dark"):
        for width in WIDTHS:
            page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=colours)
            page.goto(address)
            found[f"{width} px, {colours}"] = page.evaluate(FAULTS, SMALLEST)
            if picture is not None:
                page.screenshot(path=f"{picture}-{width}-{colours}.png", full_page=True)
            page.close()
    page = browser.new_page(viewport={"width": PAPER, "height": 1000})
    page.emulate_media(media="print")
    page.goto(address)
    found["printed"] = page.evaluate(FAULTS, SMALLEST)
    if picture is not None:
        page.screenshot(path=f"{picture}-printed.png", full_page=True)
    page.close()
    return {where: wrong for where, wrong in found.items() if wrong}
