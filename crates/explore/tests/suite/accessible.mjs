// What the page is to people with a keyboard, with a finger, or who see little contrast: in light and dark, on a small screen
// and on a tablet. Arguments: address of the browser's protocol, address of the page. Prints a JSON object of what it found.
import { connect } from "./browser.mjs";

const [browser, page] = process.argv.slice(2);
const { call, evaluate, until } = await connect(browser);
const idle = async () => {
  await new Promise(done => setTimeout(done, 250));
  await until(`document.querySelector("#words")?.textContent && !document.querySelector(".busy")`);
};

// Functions of the page: what is seen, what takes the focus, and contrast by the Web Content Accessibility Guidelines 2.2.
const inPage = `
  const isSeen = one => one.checkVisibility({ opacityProperty: true, visibilityProperty: true }) && one.getClientRects().length > 0;
  const controls = () => [...document.querySelectorAll("button, input, select, summary, a[href], [tabindex='0']")]
    .filter(one => isSeen(one) && !one.disabled);
  const named = one => (one.id && "#" + one.id) || one.getAttribute("aria-label") || one.textContent.trim().slice(0, 30) || one.outerHTML.slice(0, 80);
  const numbers = text => text.match(/[\\d.]+/g).map(Number);
  const opaque = text => { const [r, g, b, a = 1] = numbers(text); return a > 0.5 && text !== "transparent" ? [r, g, b] : null; };
  const behind = one => {
    for (let at = one; at; at = at.parentElement) {
      const found = opaque(getComputedStyle(at).backgroundColor);
      if (found) return found;
    }
    return [255, 255, 255];
  };
  // A figure in the dark: inverted, its hue turned by half a circle, on the paper behind it.
  const turned = ([r, g, b]) => {
    const [x, y, z] = [255 - r, 255 - g, 255 - b];
    const sum = 2 * (0.213 * x + 0.715 * y + 0.072 * z);
    return [sum - x, sum - y, sum - z].map(v => Math.min(255, Math.max(0, v)));
  };
  const onPaper = (color, paper, opacity) => color.map((v, k) => {
    const screened = 255 - (255 - v) * (255 - paper[k]) / 255;
    return opacity * screened + (1 - opacity) * paper[k];
  });
  const luminance = color => {
    const [r, g, b] = color.map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => {
    const [high, low] = [luminance(a), luminance(b)].sort((p, q) => q - p);
    return (high + 0.05) / (low + 0.05);
  };
  const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
  const texts = () => {
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const found = [];
    while (walker.nextNode()) {
      const one = walker.currentNode.parentElement;
      const text = walker.currentNode.data.trim();
      if (!text || !isSeen(one) || one.closest(":disabled, script, noscript, title, desc")) continue;
      const style = getComputedStyle(one);
      const figure = one.closest(".picture svg");
      let color = opaque(one instanceof SVGElement ? style.fill : style.color) ?? [0, 0, 0];
      let ground = figure ? [255, 255, 255] : behind(one);
      if (figure && isDark) {
        const paper = behind(figure.closest(".card"));
        const opacity = Number(getComputedStyle(figure).opacity);
        [color, ground] = [color, ground].map(one => onPaper(turned(one), paper, opacity));
      }
      found.push({ text: text.slice(0, 40), contrast: contrast(color, ground) });
    }
    return found;
  };
`;
const report = async body => evaluate(`(() => { ${inPage} ${body} })()`);

const found = { screens: [] };
await call("Page.enable");
await call("Accessibility.enable");
for (const [width, height, touch] of [[1280, 720, false], [820, 1180, true], [1180, 820, true]]) {
  for (const scheme of ["light", "dark"]) {
    await call("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: touch });
    await call("Emulation.setTouchEmulationEnabled", { enabled: touch });
    await call("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: scheme }] });
    await call("Page.navigate", { url: "about:blank" });
    await call("Page.navigate", { url: `${page}#view=law,frf,history` });
    await idle();
    const screen = await report(`
      const faint = texts().filter(one => one.contrast < 4.5);
      const small = controls().filter(one => !one.matches("input[type=range]")).map(one => {
        const { width, height } = one.getBoundingClientRect();
        return { name: named(one), width, height };
      }).filter(one => Math.min(one.width, one.height) < 24);
      return { texts: texts().length, faint, small, overflow: document.documentElement.scrollWidth - innerWidth,
               coarse: matchMedia("(pointer: coarse)").matches };
    `);
    found.screens.push({ width, height, scheme, touch, ...screen });
  }
}

// Names of all that takes the focus, and a way through them by the keyboard alone.
await call("Emulation.clearDeviceMetricsOverride");
await call("Emulation.setTouchEmulationEnabled", { enabled: false });
await call("Page.navigate", { url: "about:blank" });
await call("Page.navigate", { url: `${page}#view=law,frf` });
await idle();
const { nodes } = await call("Accessibility.getFullAXTree");
const roles = new Set(["button", "checkbox", "combobox", "link", "slider", "spinbutton", "textbox", "DisclosureTriangle", "image", "img"]);
const asked = nodes.filter(one => !one.ignored && roles.has(one.role?.value));
found.named = asked.length;
found.nameless = asked.filter(one => !one.name?.value?.trim()).map(one => one.role.value);
const key = async (name, code, text) => {
  await call("Input.dispatchKeyEvent", { type: "keyDown", key: name, windowsVirtualKeyCode: code, text });
  await call("Input.dispatchKeyEvent", { type: "keyUp", key: name, windowsVirtualKeyCode: code });
};
await evaluate(`document.activeElement?.blur()`);
const count = await report(`controls().forEach((one, k) => one.setAttribute("data-place", k)); return controls().length;`);
const reached = new Set();
found.unmarked = [];
for (let k = 0; k < count + 20; k++) {
  await key("Tab", 9);
  const at = await report(`
    const one = document.activeElement;
    const style = getComputedStyle(one);
    return { place: one.getAttribute("data-place"), name: named(one), marked: one.matches(":focus-visible") && style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0 };
  `);
  if (at.place === null) continue;
  if (!reached.has(at.place) && !at.marked) found.unmarked.push(at.name);
  reached.add(at.place);
}
found.count = count;
found.missed = await report(`return controls().filter(one => one.dataset.place !== undefined && !${JSON.stringify([...reached])}.includes(one.dataset.place)).map(named);`);
// A slider and a switch of a view by keys.
const words = () => evaluate(`document.querySelector("#words").textContent`);
const before = await words();
await evaluate(`document.querySelector("#controls input[type=range]").focus()`);
for (let k = 0; k < 5; k++) await key("ArrowRight", 39);
await idle();
found.slid = (await words()) !== before;
await evaluate(`document.querySelector("#views button:last-child").focus()`);
await key(" ", 32, " ");
await idle();
found.shown = await evaluate(`document.querySelector("#views button:last-child").getAttribute("aria-pressed")`);
console.log(JSON.stringify(found));
process.exit(0);
