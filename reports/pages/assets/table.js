// Tables sort by the column whose heading is pressed: numbers by value, texts by their words and the numbers in them; what is missing comes last.
document.querySelectorAll("table.sorts").forEach((table) => {
  const words = new Intl.Collator("en", { numeric: true });
  const value = (text, numeric) => {
    if (text === "" || text === "-") return null;
    if (!numeric) return text;
    const levels = text.split(" then ").map((part) => parseFloat(part.replace(/,/g, "")));
    return levels.some(Number.isNaN) ? null : levels;
  };
  const compare = (a, b) => {
    if (typeof a === "string") return words.compare(a, b);
    const k = a.findIndex((one, level) => one !== b[level]);
    return k < 0 ? 0 : a[k] < b[k] ? -1 : 1;
  };
  table.querySelectorAll("thead th").forEach((head) => {
    head.querySelector("button")?.addEventListener("click", () => {
      const upwards = head.getAttribute("aria-sort") !== "ascending";
      const numeric = head.classList.contains("n");
      table.querySelectorAll("th[aria-sort]").forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", upwards ? "ascending" : "descending");
      const body = table.tBodies[0];
      const rows = Array.from(body.rows, (row) => [value(row.cells[head.cellIndex].textContent.trim(), numeric), row]);
      rows.sort(([a], [b]) => (a === null || b === null ? (a === null) - (b === null) : upwards ? compare(a, b) : compare(b, a)));
      body.append(...rows.map(([, row]) => row));
    });
  });
});
