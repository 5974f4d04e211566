// Pictures that follow each other: a button starts and stops, a slider shows any of them.
document.querySelectorAll(".animation").forEach((film) => {
  const pictures = film.querySelectorAll("img");
  const lines = film.querySelectorAll(".moment");
  const slider = film.querySelector("input");
  const button = film.querySelector("button");
  let clock = null;
  const show = (at) => {
    slider.value = at;
    pictures.forEach((picture, k) => { picture.hidden = k !== at; });
    lines.forEach((line, k) => { line.hidden = k !== at; });
  };
  const stop = () => {
    clearInterval(clock);
    clock = null;
    button.textContent = "\u25b6";
    button.setAttribute("aria-label", "play");
  };
  const step = () => (Number(slider.value) + 1 < pictures.length ? show(Number(slider.value) + 1) : stop());
  slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
  button.addEventListener("click", () => {
    if (clock !== null) return stop();
    if (Number(slider.value) + 1 === pictures.length) show(0);
    button.textContent = "\u23f8";
    button.setAttribute("aria-label", "stop");
    clock = setInterval(step, Number(film.dataset.milliseconds));
  });
});
