// Maps that zoom and move, and tell of the route or the stop that is picked.
document.querySelectorAll("figure.map").forEach((figure) => {
  const map = figure.querySelector("svg.routes");
  const facts = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
  const lines = map.querySelectorAll(".route");
  const buttons = figure.querySelectorAll(".legend button");
  const told = figure.querySelector(".told");
  const hint = told.firstElementChild;
  const ring = map.querySelector(".ring");
  const whole = { ...["x", "y", "width", "height"].reduce((box, side) => ({ ...box, [side]: map.viewBox.baseVal[side] }), {}) };
  let view = { ...whole };

  const unit = () => view.width / map.clientWidth;
  const show = () => {
    map.setAttribute("viewBox", `${view.x} ${view.y} ${view.width} ${view.height}`);
    map.style.setProperty("--unit", unit());
    map.classList.toggle("zoomed", view.width < whole.width * 0.999);
  };
  const within = (at, low, high) => Math.min(Math.max(at, low), high);
  const move = (dx, dy) => {
    view.x = within(view.x + dx, whole.x, whole.x + whole.width - view.width);
    view.y = within(view.y + dy, whole.y, whole.y + whole.height - view.height);
    show();
  };
  const zoom = (factor, x = view.x + view.width / 2, y = view.y + view.height / 2) => {
    const width = within(view.width / factor, whole.width / 60, whole.width);
    const share = width / view.width;
    view = { x: x - (x - view.x) * share, y: y - (y - view.y) * share, width, height: view.height * share };
    move(0, 0);
  };
  const reset = () => { view = { ...whole }; show(); };
  const place = (event) => {
    const box = map.getBoundingClientRect();
    return [view.x + (event.clientX - box.left) * unit(), view.y + (event.clientY - box.top) * unit()];
  };

  const element = (name, text, kind) => {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    if (kind) made.className = kind;
    return made;
  };
  const list = (labels, values) => {
    const made = element("dl", undefined, "facts");
    labels.forEach((label, k) => {
      if (values[k] === "") return;
      const row = element("div");
      row.append(element("dt", label.replace(/_/g, " ")), element("dd", values[k]));
      made.append(row);
    });
    return made;
  };
  const pick = (number, position) => {
    const route = facts.routes[number];
    const stop = route?.stops[position];
    lines.forEach((line, k) => line.classList.toggle("picked", k === number));
    buttons.forEach((button, k) => button.setAttribute("aria-pressed", k === number));
    map.classList.toggle("some", route !== undefined);
    ring.toggleAttribute("hidden", stop === undefined);
    if (route === undefined) return told.replaceChildren(hint);
    told.replaceChildren(element("h3", stop ? `Site ${stop.id}, stop ${position + 1} of ${route.name}` : route.name));
    told.append(stop ? list(facts.of_stop, stop.facts) : list(facts.of_route, route.facts));
    if (stop) [ring.style.cx, ring.style.cy] = stop.at.map((at) => `${at}px`);
    const stops = element("ol", undefined, "stops");
    route.stops.forEach((other, k) => {
      const button = element("button", other.id);
      button.type = "button";
      button.setAttribute("aria-pressed", k === position);
      button.addEventListener("click", () => {
        pick(number, k);
        told.querySelectorAll(".stops button")[k].focus();
      });
      stops.append(element("li"));
      stops.lastChild.append(button);
    });
    told.append(stops);
  };

  const nearest = ([x, y], reach) => {
    let best = null;
    facts.routes.forEach((route, k) => route.stops.forEach((stop, position) => {
      const far = Math.hypot(stop.at[0] - x, stop.at[1] - y);
      if (far < reach) { reach = far; best = [k, position]; }
    }));
    return best;
  };
  const fingers = new Map();
  let moved = false;
  map.addEventListener("pointerdown", (event) => {
    if (fingers.size === 0) moved = false;
    fingers.set(event.pointerId, event);
  });
  map.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (before === undefined) return;
    const dx = event.clientX - before.clientX;
    const dy = event.clientY - before.clientY;
    if (!moved && Math.hypot(dx, dy) < 4) return;
    moved = true;
    map.setPointerCapture(event.pointerId);
    if (fingers.size === 2) {
      const other = [...fingers.values()].find((finger) => finger.pointerId !== event.pointerId);
      const apart = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
      zoom(apart(event) / Math.max(apart(before), 1), ...place(other));
    } else {
      move(-dx * unit(), -dy * unit());
    }
    fingers.set(event.pointerId, event);
  });
  ["pointerup", "pointercancel"].forEach((name) => map.addEventListener(name, (event) => fingers.delete(event.pointerId)));
  map.addEventListener("click", (event) => {
    if (moved) return;
    const stop = nearest(place(event), (event.pointerType === "touch" ? 24 : 12) * unit());
    const line = event.target.closest(".route");
    pick(...(stop ?? (line ? [Number(line.dataset.route)] : [])));
  });
  map.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 300), ...place(event));
  }, { passive: false });
  map.addEventListener("keydown", (event) => {
    const step = view.width / 8;
    const act = {
      ArrowLeft: () => move(-step, 0), ArrowRight: () => move(step, 0), ArrowUp: () => move(0, -step), ArrowDown: () => move(0, step),
      "+": () => zoom(1.5), "=": () => zoom(1.5), "-": () => zoom(1 / 1.5), 0: reset, Escape: () => pick(),
    }[event.key];
    if (act === undefined || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    act();
  });
  figure.querySelectorAll("[data-zoom]").forEach((button) => {
    const factor = Number(button.dataset.zoom);
    button.addEventListener("click", () => (factor ? zoom(factor) : reset()));
  });
  buttons.forEach((button, k) => button.addEventListener("click", () => pick(button.getAttribute("aria-pressed") === "true" ? undefined : k)));
  new ResizeObserver(show).observe(map);
});
