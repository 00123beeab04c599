// Colour maps of fields; red, green and blue from 0 to 1.

const MAPS = {
  plain: ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"], // viridis
  damage: ["#cfd8e0", "#e9c9a8", "#f0a35e", "#dd6b2f", "#b02a1e", "#6d0f1c"],
  signed: ["#2166ac", "#67a9cf", "#d1e5f0", "#f7f7f7", "#fddbc7", "#ef8a62", "#b2182b"],
};

const SIZE = 256;

function table(stops) {
  const rgb = stops.map((stop) => [1, 3, 5].map((at) => parseInt(stop.slice(at, at + 2), 16) / 255));
  return Array.from({ length: SIZE }, (_, i) => {
    const place = (i / (SIZE - 1)) * (rgb.length - 1);
    const below = Math.min(Math.floor(place), rgb.length - 2);
    return rgb[below].map((value, channel) => value + (place - below) * (rgb[below + 1][channel] - value));
  });
}

const TABLES = Object.fromEntries(Object.entries(MAPS).map(([name, stops]) => [name, table(stops)]));

export function colour(map, share) {
  return TABLES[map][Math.round(Math.min(Math.max(share, 0), 1) * (SIZE - 1))];
}

export function gradient(map) {
  return `linear-gradient(to right, ${MAPS[map].join(", ")})`;
}
