// Mends what the theme leaves out for screen readers and keyboards: levels of captions, names of asides, empty heads of
// tables, and the focus of what scrolls.
document.addEventListener("DOMContentLoaded", () => {
  const all = (selector, change) => document.querySelectorAll(selector).forEach(change);
  all(".caption[role=heading]", caption => caption.setAttribute("aria-level", "2"));
  all("aside.sidebar-drawer", aside => aside.setAttribute("aria-label", "Pages"));
  all("aside.toc-drawer", aside => aside.setAttribute("aria-label", "On this page"));
  all("thead", head => head.textContent.trim() || head.remove());
  all("th", cell => cell.textContent.trim() || cell.replaceWith(document.createElement("td")));
  all("pre, .table-wrapper", box => (box.tabIndex = 0));
});
