// Divides the picture into panels, a molecule in each.

const NAME_ROOM = 36; // pixels of the page; above a molecule and its margin, for its name
const WIDE_LEGEND = 0.3; // part of the width of a page from which a legend gets room below the molecule

// Returns the rectangles of the panels in a picture of this size, from the upper left, with the `middle` and the
// height (`room`) of what names and legend leave free.
function panelsOf(count, width, height) {
  const sizes = Array.from({ length: count }, (_, i) => [i + 1, Math.ceil(count / (i + 1))]);
  const side = ([columns, rows]) => Math.min(width / columns, height / rows);
  const [columns, rows] = sizes.reduce((best, one) => side(one) > side(best) ? one : best);
  const across = width / columns, down = height / rows;
  // The picture may have more or fewer pixels than the page.
  const perPixel = height / (canvas.clientHeight || height);
  const above = Math.min(NAME_ROOM * perPixel, down / 4), below = Math.min(legendRoom(count) * perPixel, down / 4);
  return Array.from({ length: count }, (_, i) => {
    const x = i % columns * across, y = Math.floor(i / columns) * down, room = down - above - below;
    return { x, y, width: across, height: down, room, middle: [x + across / 2, y + above + room / 2] };
  });
}

// Returns the pixels of the page below a single molecule that a legend as wide as most of it needs.
function legendRoom(count) {
  const { offsetWidth, offsetHeight } = $("legend");
  return count === 1 && offsetWidth > WIDE_LEGEND * canvas.clientWidth ? offsetHeight + 8 : 0;
}
