// The page around the plots: bar with switches, contents, tables for narrow screens, keys, help.

const KEYS = [
  ["j, k", "next and previous section"],
  ["drag", "zoom to a range; with Shift: move it"],
  ["Ctrl + wheel", "zoom at the pointer"],
  ["double click", "show everything"],
  ["Tab", "next plot; in a plot:"],
  ["← →", "cursor; with Shift: move the range"],
  ["+ −", "zoom at the cursor"],
  ["Esc", "show everything"],
  ["0", "all plots: show everything"],
  ["m", "markers on and off"],
  ["?", "this list"],
];

function made(name, className, ...content) {
  const element = document.createElement(name);
  if (className) element.className = className;
  element.append(...content);
  return element;
}

function button(className, text, title, action) {
  const element = made("button", className, text);
  element.type = "button";
  element.title = title;
  element.addEventListener("click", action);
  return element;
}

function startBar() {
  if (linked.plots.length === 0) return;
  const rows = KEYS.map(([keys, text]) => made("tr", "", made("td", "", made("kbd", "", keys)), made("td", "", text)));
  const help = made("dialog", "help", made("h3", "", "Keys and pointer"), made("table", "", made("tbody", "", ...rows)));
  help.addEventListener("click", () => help.close());
  const all = button("reset", "Show everything", "Key: 0", reset);
  all.disabled = true;
  const bar = made("div", "bar", made("span", "switches", ...markSwitches(redrawAll)), made("span", "range"), all,
    button("keys", "?", "Keys", () => help.showModal()));
  bar.setAttribute("role", "toolbar");
  bar.setAttribute("aria-label", "Plots");
  let first = linked.plots[0].root;
  while (first.parentElement.tagName !== "MAIN") first = first.parentElement;
  first.before(bar);
  document.body.append(help);
}

// Marks the section in sight in the contents.
function startContents() {
  const links = new Map();
  for (const link of document.querySelectorAll("nav.contents a")) links.set(link.hash.slice(1), link);
  const headings = Array.from(document.querySelectorAll("h2[id]")).filter((one) => links.has(one.id));
  let current = null;
  const update = () => {
    const past = headings.filter((one) => one.getBoundingClientRect().top < innerHeight * 0.35);
    const now = links.get((past.at(-1) ?? headings[0])?.id);
    if (now === current) return;
    current?.removeAttribute("aria-current");
    now?.setAttribute("aria-current", "true");
    current = now;
  };
  addEventListener("scroll", update, { passive: true });
  update();
  return headings;
}

// Sets a table that is wider than the page as one block for each row, with the heads of its columns.
function stackTables() {
  const tables = Array.from(document.querySelectorAll("main table:not(.cards)"));
  for (const table of tables) table.classList.remove("stacked");
  const room = (box) => {
    const style = getComputedStyle(box);
    return box.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
  };
  const wide = tables.filter((table) => table.scrollWidth > room(table.parentElement) + 1 || table.clientWidth + 1 < table.scrollWidth);
  for (const table of wide) {
    const heads = Array.from(table.querySelectorAll("thead tr:last-child th"), (th) => th.textContent.trim());
    for (const row of table.querySelectorAll("tbody tr")) {
      let column = 0;
      for (const cell of row.cells) {
        if (heads[column] && cell.colSpan === 1) cell.dataset.label = heads[column];
        column += cell.colSpan;
      }
    }
    table.classList.add("stacked");
  }
}

// A field above a long table that shows the rows which have all of its words.
function startFilters() {
  for (const table of document.querySelectorAll("table.filtered")) {
    const rows = Array.from(table.tBodies[0].rows, (row) => ({ row, text: row.textContent.toLowerCase() }));
    const field = made("input", "filter");
    field.type = "search";
    field.placeholder = "Filter: words of a case, a factor, a verdict";
    field.setAttribute("aria-label", "Filter of the rows");
    const count = made("output", "soft");
    field.addEventListener("input", () => {
      const words = field.value.toLowerCase().split(/\s+/).filter((word) => word !== "");
      let shown = 0;
      for (const { row, text } of rows) {
        row.hidden = !words.every((word) => text.includes(word));
        shown += row.hidden ? 0 : 1;
      }
      count.textContent = words.length > 0 ? ` ${shown} of ${rows.length}` : "";
    });
    (table.closest(".wide") ?? table).before(field, count);
  }
}

function startKeys(headings) {
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches?.("input:not([type=checkbox]), textarea, select")) return;
    const jump = (by) => {
      const tops = headings.map((one) => one.getBoundingClientRect().top);
      const next = by > 0 ? headings.find((_, i) => tops[i] > 80) : headings.findLast((_, i) => tops[i] < -8);
      if (next) location.hash = next.id;
      next?.scrollIntoView();
    };
    const actions = {
      j: () => jump(1),
      k: () => jump(-1),
      0: reset,
      m: () => {
        const boxes = Array.from(document.querySelectorAll(".switch input"));
        const on = !boxes.some((box) => box.checked);
        for (const box of boxes) if (box.checked !== on) box.click();
      },
      "?": () => document.querySelector("dialog.help")?.showModal(),
    };
    actions[event.key]?.();
  });
}

startPlots();
startBar();
startFilters();
startKeys(startContents());
stackTables();
addEventListener("resize", stackTables);
for (const details of document.querySelectorAll("details")) details.addEventListener("toggle", stackTables);
