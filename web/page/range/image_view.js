// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The pixels of a frame as an image that can be moved and enlarged; unknown pixels are hatched.
const ImageView = (() => {
  'use strict';
  const kMargin = 0.96;      // of the picture is filled by the image at first
  const kLargestPixel = 60;  // [px] of the page that a pixel is shown with at most
  const kHatch = 6;          // [px] from one line of the hatching to the next

  function make(canvas, width, height) {
    const context = canvas.getContext('2d');
    const image = document.createElement('canvas');
    image.width = width;
    image.height = height;
    const pixels = image.getContext('2d');
    let scale = 1, left = 0, top = 0, moved = false, shown = { width: 1, height: 1 };

    const smallest = () => kMargin * Math.min(shown.width / width, shown.height / height);

    const camera = {
      home() {
        scale = smallest();
        left = (shown.width - scale * width) / 2;
        top = (shown.height - scale * height) / 2;
        moved = false;
      },
      pan(dx, dy) {
        left += dx;
        top += dy;
        moved = true;
      },
      /** `place` keeps its pixel; without it the middle of the picture does. A factor below 1 enlarges. */
      zoom(factor, place = { x: shown.width / 2, y: shown.height / 2 }) {
        const next = Math.min(Math.max(scale / factor, smallest() / 2), Math.max(kLargestPixel, smallest()));
        left = place.x - (place.x - left) * next / scale;
        top = place.y - (place.y - top) * next / scale;
        scale = next;
        moved = true;
      },
      resize(newWidth, newHeight) {
        shown = { width: newWidth, height: newHeight };
        if (!moved) camera.home();
      },
    };
    camera.turn = camera.pan;

    /** Lines that show where nothing is known, in the size of the page whatever the image's. */
    function hatching(color, ratio) {
      const tile = document.createElement('canvas'), size = Math.round(kHatch * ratio);
      tile.width = tile.height = size;
      const pen = tile.getContext('2d');
      pen.strokeStyle = color;
      pen.lineWidth = 1.4 * ratio;
      for (const shift of [-size, 0, size]) {
        pen.beginPath();
        pen.moveTo(shift, size);
        pen.lineTo(shift + size, 0);
        pen.stroke();
      }
      return context.createPattern(tile, 'repeat');
    }

    return {
      camera,
      /** Packed colours of all pixels. */
      setColors(colors) {
        pixels.putImageData(new ImageData(new Uint8ClampedArray(colors.buffer), width, height), 0, 0);
      },
      /** `mark`: the pixel whose values are told, or null. */
      draw({ hatch, sign, line }, mark) {
        const ratio = Page.pixelRatio();
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.clearRect(0, 0, canvas.width, canvas.height);
        const box = [left, top, scale * width, scale * height].map((x) => x * ratio);
        context.fillStyle = hatching(hatch, ratio);
        context.fillRect(...box);
        context.imageSmoothingEnabled = scale * ratio < 1;
        context.imageSmoothingQuality = 'high';
        context.drawImage(image, ...box);
        context.strokeStyle = line;
        context.lineWidth = ratio;
        context.strokeRect(...box);
        if (!mark) return;
        const around = Math.max(0, 5 - scale / 2) * ratio;
        context.strokeStyle = sign;
        context.lineWidth = 1.5 * ratio;
        context.strokeRect((left + mark.column * scale) * ratio - around, (top + mark.row * scale) * ratio - around,
          scale * ratio + 2 * around, scale * ratio + 2 * around);
      },
      /** The pixel at a place in the picture, or null. */
      pixelAt({ x, y }) {
        const column = Math.floor((x - left) / scale), row = Math.floor((y - top) / scale);
        return column >= 0 && column < width && row >= 0 && row < height ? { column, row } : null;
      },
      /** Where in the picture the middle of a pixel is shown. */
      placeOf: ({ column, row }) => ({ x: left + (column + 0.5) * scale, y: top + (row + 0.5) * scale }),
    };
  }

  return { make };
})();
