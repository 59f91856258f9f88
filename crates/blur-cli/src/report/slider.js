for (const pair of document.querySelectorAll(".compare")) {
  const slider = document.createElement("input");
  slider.type = "range";
  slider.value = 50;
  slider.setAttribute("aria-label", "How much of the picture is shown as photographed, in per cent");
  const move = () => pair.style.setProperty("--at", `${slider.value}%`);
  // A finger or a pressed button on the pictures takes the edge along.
  const follow = (event) => {
    if (event.buttons === 0 || event.target === slider) return;
    const box = pair.firstElementChild.getBoundingClientRect();
    slider.value = 100 * (event.clientX - box.left) / box.width;
    move();
  };
  slider.addEventListener("input", move);
  pair.addEventListener("pointerdown", follow);
  pair.addEventListener("pointermove", follow);
  pair.addEventListener("dragstart", (event) => event.preventDefault());
  pair.classList.add("live");
  pair.append(slider);
  move();
}
