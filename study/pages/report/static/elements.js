// Elements of SVG and of HTML from their attributes and what they hold; a text is never read as HTML.
"use strict";
window.ELEMENTS = (() => {
  const maker = (space) => (tag, attributes = {}, ...content) => {
    const element = document.createElementNS(space, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...content);
    return element;
  };
  return { svg: maker("http://www.w3.org/2000/svg"), html: maker("http://www.w3.org/1999/xhtml") };
})();
