#!/usr/bin/env python3
"""Draws timer.svg and drive.svg beside itself. Coordinates are pixels, right and down.

A wire whose end meets nothing is an error, and so is a corner or an end on the middle of another wire without a dot.
"""

from pathlib import Path

INK = "#111"
GREY = "#666"


class Sheet:
    """One drawing, with what its wires may end on."""

    def __init__(self, name, width, height):
        self.name, self.width, self.height = name, width, height
        self.parts = []
        self.wires = []
        self.dots = set()
        self.terminals = []

    def add(self, element):
        self.parts.append(element)

    def line(self, *points, dash=False, width=1.6):
        path = " ".join(f"{x},{y}" for x, y in points)
        dashes = ' stroke-dasharray="6 4"' if dash else ""
        colour = GREY if dash else INK
        self.add(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"{dashes}/>')

    def rect(self, x, y, width, height, fill="#fff", dash=False):
        dashes = ' stroke-dasharray="6 4"' if dash else ""
        colour = GREY if dash else INK
        self.add(
            f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}" stroke="{colour}" '
            f'stroke-width="1.6"{dashes}/>'
        )

    def text(self, x, y, text, anchor="start", size=15, bold=False, colour=INK):
        weight = ' font-weight="bold"' if bold else ""
        text = text.replace("&", "&amp;").replace("<", "&lt;")
        self.add(
            f'<text x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}" fill="{colour}"{weight}>{text}</text>'
        )

    def wire(self, *points):
        for (x0, y0), (x1, y1) in zip(points, points[1:]):
            assert x0 == x1 or y0 == y1, f"{self.name}: a slanted wire {points}"
        self.wires.append(points)
        self.line(*points)

    def dot(self, x, y):
        self.dots.add((x, y))
        self.add(f'<circle cx="{x}" cy="{y}" r="4" fill="{INK}"/>')

    def terminal(self, *points):
        self.terminals.extend(points)

    # Symbols. Each has its terminals where its leads end.

    def ground(self, x, y):
        self.line((x, y), (x, y + 8))
        for i, half in enumerate((12, 8, 4)):
            self.line((x - half, y + 8 + 5 * i), (x + half, y + 8 + 5 * i), width=2)
        self.terminal((x, y))

    def supply(self, x, y, text="+5 V"):
        self.line((x, y), (x, y - 10))
        self.line((x - 7, y - 4), (x, y - 12), (x + 7, y - 4))
        self.text(x, y - 17, text, "middle", 14)
        self.terminal((x, y))

    def resistor_h(self, x, y, name, value):
        """60 wide; (x, y) is its left end."""
        self.line((x, y), (x + 10, y))
        self.line((x + 50, y), (x + 60, y))
        self.rect(x + 10, y - 8, 40, 16)
        self.text(x + 30, y - 14, f"{name}\u2002{value}", "middle")
        self.terminal((x, y), (x + 60, y))

    def resistor_v(self, x, y, name, value, side=1):
        """60 high; (x, y) is its upper end. The text stands to the right, or with side -1 to the left."""
        self.line((x, y), (x, y + 10))
        self.line((x, y + 50), (x, y + 60))
        self.rect(x - 8, y + 10, 16, 40)
        anchor = "start" if side > 0 else "end"
        self.text(x + 15 * side, y + 27, name, anchor)
        self.text(x + 15 * side, y + 45, value, anchor)
        self.terminal((x, y), (x, y + 60))

    def capacitor_v(self, x, y, name, value, polarised=False, side=1, length=40):
        """(x, y) is its upper end, which is the positive one."""
        middle = y + length // 2
        self.line((x, y), (x, middle - 4))
        self.line((x, middle + 4), (x, y + length))
        self.line((x - 13, middle - 4), (x + 13, middle - 4), width=2.4)
        self.line((x - 13, middle + 4), (x + 13, middle + 4), width=2.4)
        if polarised:
            self.text(x - 13 * side, middle - 8, "+", "middle", 14)
        anchor = "start" if side > 0 else "end"
        self.text(x + 19 * side, middle - 2, name, anchor)
        self.text(x + 19 * side, middle + 15, value, anchor)
        self.terminal((x, y), (x, y + length))

    def diode_left(self, x, y, name, value):
        """60 wide; (x, y) is its left end, the cathode."""
        self.line((x, y), (x + 60, y))
        self.add(f'<polygon points="{x + 40},{y - 10} {x + 40},{y + 10} {x + 22},{y}" fill="#fff" stroke="{INK}" '
                 f'stroke-width="1.6"/>')
        self.line((x + 22, y - 10), (x + 22, y + 10), width=2.4)
        self.text(x + 30, y - 16, name, "middle")
        self.text(x + 30, y + 28, value, "middle")
        self.terminal((x, y), (x + 60, y))

    def led_down(self, x, y):
        """A bare light-emitting diode, 50 high; (x, y) is its anode."""
        self.line((x, y), (x, y + 50))
        self.add(f'<polygon points="{x - 10},{y + 16} {x + 10},{y + 16} {x},{y + 34}" fill="#fff" stroke="{INK}" '
                 f'stroke-width="1.6"/>')
        self.line((x - 10, y + 34), (x + 10, y + 34), width=2.4)
        for shift in (0, 11):
            self.arrow(x + 14, y + 18 + shift, x + 28, y + 18 + shift)
        self.terminal((x, y), (x, y + 50))

    def arrow(self, x0, y, x1, _):
        self.line((x0, y), (x1, y), width=1.3)
        tip = 5 if x1 > x0 else -5
        self.line((x1 - tip, y - 3), (x1, y), (x1 - tip, y + 3), width=1.3)

    def switch_v(self, x, y, name, remarks, closed=False, length=60):
        """(x, y) is its upper end. The text stands to the left."""
        middle = y + length // 2
        self.line((x, y), (x, middle - 13))
        self.line((x, middle + 13), (x, y + length))
        if closed:
            # The blade touches the far contact from the other side: normally closed.
            self.line((x, middle - 13), (x + 8, middle - 13))
            self.line((x, middle + 13), (x + 10, middle - 18), width=2.2)
        else:
            self.line((x, middle + 13), (x - 16, middle - 12), width=2.2)
        for end in (-13, 13):
            self.add(f'<circle cx="{x}" cy="{middle + end}" r="2.5" fill="{INK}"/>')
        for i, remark in enumerate((name, *remarks)):
            self.text(x - 24, middle - 9 * len(remarks) + 5 + 18 * i, remark, "end")
        self.terminal((x, y), (x, y + length))

    def switch_h(self, x, y, name, remark):
        """60 wide; (x, y) is its left end."""
        self.line((x, y), (x + 17, y))
        self.line((x + 43, y), (x + 60, y))
        self.line((x + 17, y), (x + 42, y - 15), width=2.2)
        for end in (17, 43):
            self.add(f'<circle cx="{x + end}" cy="{y}" r="2.5" fill="{INK}"/>')
        self.text(x + 30, y - 22, name, "middle")
        self.text(x + 30, y + 24, remark, "middle")
        self.terminal((x, y), (x + 60, y))

    def fuse_h(self, x, y, name, value):
        """60 wide; (x, y) is its left end."""
        self.line((x, y), (x + 10, y))
        self.line((x + 50, y), (x + 60, y))
        self.rect(x + 10, y - 8, 40, 16)
        self.line((x + 10, y), (x + 50, y))
        self.text(x + 30, y - 22, name, "middle")
        self.text(x + 30, y + 24, value, "middle")
        self.terminal((x, y), (x + 60, y))

    def jumper_v(self, x, y, name, remarks):
        """50 high; (x, y) is its upper end. The text stands to the left."""
        self.line((x, y), (x, y + 14))
        self.line((x, y + 36), (x, y + 50))
        for end in (18, 32):
            self.add(f'<circle cx="{x}" cy="{y + end}" r="4" fill="#fff" stroke="{INK}" stroke-width="1.6"/>')
        self.rect(x - 10, y + 9, 20, 32, "none", dash=True)
        for i, remark in enumerate((name, *remarks)):
            self.text(x - 18, y + 33 - 9 * len(remarks) + 18 * i, remark, "end")
        self.terminal((x, y), (x, y + 50))

    def motor(self, x, y, name, remarks):
        """100 high; (x, y) is its upper end."""
        self.line((x, y), (x, y + 26))
        self.line((x, y + 74), (x, y + 100))
        self.add(f'<circle cx="{x}" cy="{y + 50}" r="24" fill="#fff" stroke="{INK}" stroke-width="1.6"/>')
        self.text(x, y + 56, "M", "middle", 18, bold=True)
        for i, remark in enumerate((name, *remarks)):
            self.text(x - 32, y + 55 - 9 * len(remarks) + 18 * i, remark, "end")
        self.terminal((x, y), (x, y + 100))

    def pot_v(self, x, y, name, value):
        """100 high; (x, y) is its upper end, the wiper comes from the left, 40 away, at half height."""
        self.line((x, y), (x, y + 25))
        self.line((x, y + 75), (x, y + 100))
        self.rect(x - 8, y + 25, 16, 50)
        self.line((x - 40, y + 50), (x - 9, y + 50))
        self.line((x - 16, y + 45), (x - 9, y + 50), (x - 16, y + 55))
        self.text(x + 15, y + 47, name)
        self.text(x + 15, y + 65, value)
        self.terminal((x, y), (x, y + 100), (x - 40, y + 50))

    def plug(self, x, name, pins):
        """A connector, 28 wide, whose pins are (y, number); wires meet it at x and at x + 28."""
        top, bottom = min(y for y, _ in pins) - 18, max(y for y, _ in pins) + 18
        self.rect(x, top, 28, bottom - top, "#eef3fa")
        self.text(x + 14, top - 7, name, "middle", bold=True)
        for y, number in pins:
            self.text(x + 14, y + 5, str(number), "middle", 14)
            self.terminal((x, y), (x + 28, y))

    def box(self, x, y, width, height, title, left=(), right=(), top=(), bottom=(), title_y=None, title_x=None):
        """A part with named pins; left and right pins are (y, name), top and bottom ones (x, name)."""
        self.rect(x, y, width, height, "#fbf8ec")
        title_x = x + width // 2 if title_x is None else title_x
        title_y = y + height // 2 if title_y is None else title_y
        for i, row in enumerate(title):
            self.text(title_x, title_y + 19 * i, row, "middle", 15 if i else 16, bold=not i)
        for pin, name in left:
            self.text(x + 7, pin + 5, name, size=14)
            self.terminal((x, pin))
        for pin, name in right:
            self.text(x + width - 7, pin + 5, name, "end", 14)
            self.terminal((x + width, pin))
        for pin, name in top:
            self.text(pin, y + 18, name, "middle", 14)
            self.terminal((pin, y))
        for pin, name in bottom:
            self.text(pin, y + height - 8, name, "middle", 14)
            self.terminal((pin, y + height))

    # Checks and output.

    def check(self):
        ends = [end for wire in self.wires for end in (wire[0], wire[-1])]
        for end in ends:
            assert end in self.terminals or end in self.dots or ends.count(end) > 1, f"{self.name}: loose end {end}"
        for terminal in self.terminals:
            for wire in self.wires:
                inside = any(strictly_between(terminal, *leg) for leg in zip(wire, wire[1:]))
                assert not inside or terminal in self.dots, f"{self.name}: no dot at {terminal}"
        for end in set(ends):
            for wire in self.wires:
                inside = any(strictly_between(end, *leg) for leg in zip(wire, wire[1:]))
                assert not inside or end in self.dots, f"{self.name}: no dot at {end}"
        for dot in self.dots:
            legs = ends.count(dot) + self.terminals.count(dot)
            legs += 2 * sum(strictly_between(dot, *leg) for wire in self.wires for leg in zip(wire, wire[1:]))
            legs += 2 * sum(dot in wire[1:-1] for wire in self.wires)
            assert legs >= 3, f"{self.name}: a dot that joins nothing at {dot}"
        for wire in self.wires:
            for leg in zip(wire, wire[1:]):
                for other in self.wires:
                    for leg2 in zip(other, other[1:]):
                        assert not crosses(leg, leg2), f"{self.name}: {leg} crosses {leg2}"

    def write(self):
        self.check()
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" width="{self.width}" '
            f'height="{self.height}" font-family="Helvetica, Arial, \'DejaVu Sans\', sans-serif" '
            f'stroke-linecap="round" stroke-linejoin="round">'
        )
        # A background of its own, so that it can be read on a dark page.
        ground = f'<rect width="{self.width}" height="{self.height}" fill="#fff"/>'
        text = "\n".join([head, ground, *self.parts, "</svg>", ""])
        (Path(__file__).parent / f"{self.name}.svg").write_text(text, encoding="utf-8", newline="\n")


def strictly_between(point, a, b):
    (x, y), (x0, y0), (x1, y1) = point, a, b
    if x0 == x1:
        return x == x0 and min(y0, y1) < y < max(y0, y1)
    return y == y0 and min(x0, x1) < x < max(x0, x1)


def crosses(leg, other):
    (a, b), (c, d) = leg, other
    if (a[0] == b[0]) == (c[0] == d[0]):
        return False
    meeting = (a[0], c[1]) if a[0] == b[0] else (c[0], a[1])
    return strictly_between(meeting, a, b) and strictly_between(meeting, c, d)


def timer():
    s = Sheet("timer", 1290, 800)
    s.text(40, 40, "timer: stamps the teeth, triggers the camera", size=20, bold=True)

    # The sensor's head.
    s.rect(30, 75, 350, 320, "none", dash=True)
    s.text(40, 385, "sensor head", colour=GREY)
    s.box(170, 120, 150, 200, ["U2", "GP1A57HRJ00F"], right=[(160, "3 VCC"), (215, "4 VO"), (270, "5 GND")],
          title_y=293)
    s.text(177, 155, "1", size=14)
    s.text(177, 265, "2", size=14)
    s.led_down(205, 190)
    s.line((170, 160), (205, 160), (205, 190))
    s.line((205, 240), (205, 270), (170, 270))
    s.terminal((170, 160), (170, 270))
    s.wire((70, 100), (105, 100))
    s.wire((105, 100), (345, 100))
    s.wire((345, 100), (400, 100))
    s.resistor_v(105, 100, "R1", "330 Ω")
    s.wire((105, 160), (170, 160))
    s.wire((320, 160), (345, 160), (345, 100))
    s.wire((320, 215), (400, 215))
    s.wire((320, 270), (345, 270), (345, 365))
    s.wire((170, 270), (105, 270), (105, 365))
    s.wire((70, 100), (70, 200))
    s.capacitor_v(70, 200, "C1", "100 nF", side=1)
    s.wire((70, 240), (70, 365), (105, 365))
    s.wire((105, 365), (345, 365))
    s.wire((345, 365), (400, 365))
    for x, y in ((105, 100), (345, 100), (105, 365), (345, 365)):
        s.dot(x, y)
    s.plug(400, "J1", [(100, 1), (215, 2), (365, 3)])

    # Between the sensor and D8.
    s.wire((428, 100), (470, 100))
    s.wire((470, 100), (470, 85))
    s.supply(470, 85)
    s.wire((470, 100), (470, 130))
    s.dot(470, 100)
    s.resistor_v(470, 130, "R2", "2.2 kΩ", side=1)
    s.wire((470, 190), (470, 215))
    s.wire((428, 215), (470, 215))
    s.wire((470, 215), (575, 215))
    s.wire((575, 215), (620, 215))
    s.dot(470, 215)
    s.dot(575, 215)
    s.wire((428, 365), (455, 365), (455, 380))
    s.ground(455, 380)
    s.jumper_v(575, 215, "JP1", ["self-test only"])
    s.resistor_v(575, 265, "R3", "330 Ω", side=-1)
    s.wire((575, 325), (575, 345), (620, 345))

    # End of travel.
    s.text(40, 650, "S1: or a second sensor head, whose flag blocks the light at the end", size=14, colour=GREY)
    s.switch_v(265, 530, "S1", ["end of travel,", "closed = reached"])
    s.wire((265, 530), (330, 530))
    s.wire((265, 590), (330, 590))
    s.plug(330, "J2", [(470, 1), (530, 2), (590, 3)])
    s.wire((358, 470), (395, 470))
    s.wire((395, 470), (395, 455))
    s.supply(395, 455)
    s.dot(395, 470)
    s.resistor_v(395, 470, "R4", "10 kΩ")
    s.wire((358, 530), (395, 530))
    s.dot(395, 530)
    s.wire((395, 530), (470, 530))
    s.resistor_h(470, 530, "R5", "1 kΩ")
    s.wire((530, 530), (580, 530))
    s.wire((580, 530), (620, 530))
    s.dot(580, 530)
    s.capacitor_v(580, 530, "C2", "100 nF", side=-1, length=50)
    s.ground(580, 580)
    s.wire((358, 590), (390, 590), (390, 600))
    s.ground(390, 600)

    # The board.
    s.box(620, 140, 170, 500, ["U1", "Arduino Nano", "ATmega328P", "16 MHz, 5 V"],
          [(215, "D8 ICP1"), (345, "D5 OC0B"), (530, "D2 INT0")],
          [(215, "D9"), (470, "D0 RX"), (540, "D1 TX")], [(680, "5V")], [(700, "GND")], title_y=375)
    s.text(705, 510, "LED: D13", "middle", 14, colour=GREY)
    s.text(705, 596, "USB: 5 V, serial", "middle", 14, colour=GREY)
    s.wire((680, 140), (680, 115))
    s.supply(680, 115)
    s.wire((700, 640), (700, 655))
    s.ground(700, 655)
    s.supply(860, 665)
    s.capacitor_v(860, 665, "C3", "47 µF", polarised=True)
    s.ground(860, 705)

    # The camera.
    s.resistor_h(840, 215, "R6", "330 Ω")
    s.wire((790, 215), (840, 215))
    s.wire((900, 215), (950, 215))
    s.box(950, 180, 130, 170, ["U3", "PC817"], title_y=373)
    s.terminal((950, 215), (950, 315), (1080, 215), (1080, 315))
    for x, y, number in ((957, 210, 1), (957, 310, 2), (1073, 310, 3), (1073, 210, 4)):
        s.text(x, y, str(number), "start" if x < 1000 else "end", 14)
    s.led_down(985, 240)
    s.line((950, 215), (985, 215), (985, 240))
    s.line((985, 290), (985, 315), (950, 315))
    # The transistor of the opto-coupler.
    s.line((1035, 245), (1035, 285), width=2.6)
    s.line((1080, 215), (1057, 215), (1057, 236), (1035, 255))
    s.line((1035, 275), (1057, 294), (1057, 315), (1080, 315))
    s.add(f'<polygon points="1057,294 1046,291 1052,284" fill="{INK}"/>')
    s.wire((950, 315), (920, 315), (920, 330))
    s.ground(920, 330)
    s.wire((1080, 215), (1220, 215))
    s.wire((1080, 315), (1165, 315))
    s.wire((1165, 315), (1220, 315))
    s.dot(1165, 315)
    s.wire((1165, 265), (1220, 265))
    s.switch_v(1165, 265, "S2", ["focus"], length=50)
    s.plug(1220, "J3", [(215, 1), (265, 2), (315, 3)])
    s.text(1234, 352, "camera", "middle")
    s.text(1230, 373, "1 release", "middle", 14)
    s.text(1230, 391, "2 focus", "middle", 14)
    s.text(1230, 409, "3 common", "middle", 14)
    s.line((1015, 150), (1015, 180), dash=True)
    s.text(1005, 150, "board", "end", 14, colour=GREY)
    s.text(1025, 150, "camera side, isolated", size=14, colour=GREY)

    # The radio.
    radio(s, 1050, 430, 870, 790, right=True)

    # Notes.
    for i, note in enumerate((
        "D8 low = tooth; D9 high = camera released; D2 low = end of travel.",
        "JP1 in place and J1 unplugged: self-test. Otherwise JP1 open: D5 is low and would hold D8 down.",
        "U4 shares D0 and D1 with the USB chip: take it out of its socket to flash or to use USB.",
    )):
        s.text(40, 745 + 20 * i, note, size=14)
    s.write()


def radio(s, x, y, node, nano, right):
    """The HC-05 with its level shifter: its box is at x, the divider at node, the Nano's edge at nano.

    D0 is at y + 40 and D1 at y + 110.
    """
    receive, transmit = y + 40, y + 110
    width = 140
    pins = [(y + 15, "VCC"), (receive, "TXD"), (transmit, "RXD"), (y + 165, "GND")]
    if right:
        s.box(x, y - 10, width, 200, ["U4", "HC-05"], left=pins, title_y=y + 72)
        s.wire((x, y + 15), (x - 45, y + 15), (x - 45, y + 5))
        s.supply(x - 45, y + 5)
        s.wire((nano, receive), (x, receive))
        s.wire((nano, transmit), (node - 60, transmit))
        s.resistor_h(node - 60, transmit, "R7", "1 kΩ")
        s.wire((node, transmit), (x, transmit))
        s.wire((x, y + 165), (x - 45, y + 165), (x - 45, y + 175))
        s.ground(x - 45, y + 175)
    else:
        s.box(x, y - 10, width, 200, ["U4", "HC-05"], right=pins, title_y=y + 72)
        edge = x + width
        s.wire((edge, y + 15), (edge + 45, y + 15), (edge + 45, y + 5))
        s.supply(edge + 45, y + 5)
        s.wire((edge, receive), (nano, receive))
        s.wire((edge, transmit), (node, transmit))
        s.resistor_h(node, transmit, "R8", "1 kΩ")
        s.wire((node + 60, transmit), (nano, transmit))
        s.wire((edge, y + 165), (edge + 45, y + 165), (edge + 45, y + 175))
        s.ground(edge + 45, y + 175)
    s.dot(node, transmit)
    s.resistor_v(node, transmit, "R8" if right else "R9", "2 kΩ")
    s.ground(node, transmit + 60)


def drive():
    s = Sheet("drive", 1290, 860)
    s.text(40, 40, "drive: moves the carriage, stops at the limit", size=20, bold=True)

    # The limit switch.
    s.switch_v(150, 190, "S2", ["limit switch,", "closed when", "not reached"], closed=True)
    s.wire((150, 190), (190, 190))
    s.wire((150, 250), (190, 250))
    s.plug(190, "J2", [(190, 1), (250, 2)])
    s.wire((218, 250), (245, 250), (245, 260))
    s.ground(245, 260)
    s.wire((218, 190), (270, 190))
    s.supply(270, 130)
    s.resistor_v(270, 130, "R1", "4.7 kΩ")
    s.dot(270, 190)
    s.wire((270, 190), (360, 190))
    s.resistor_h(360, 190, "R2", "1 kΩ")
    s.wire((420, 190), (440, 190))
    s.dot(440, 190)
    s.wire((440, 190), (540, 190))
    s.capacitor_v(440, 190, "C1", "10 nF", length=50)
    s.ground(440, 240)

    # The infra-red receiver.
    s.box(30, 340, 170, 150, ["U3", "TSOP38238", "or VS1838B"], right=[(370, "3 VS"), (415, "2 GND"), (460, "1 OUT")],
          title_y=400, title_x=88)
    s.wire((200, 370), (250, 370))
    s.dot(250, 370)
    s.wire((250, 370), (310, 370))
    s.resistor_h(310, 370, "R3", "100 Ω")
    s.wire((370, 370), (425, 370), (425, 360))
    s.supply(425, 360)
    s.capacitor_v(250, 370, "C2", "10 µF", polarised=True, length=45)
    s.wire((200, 415), (250, 415))
    s.dot(250, 415)
    s.wire((250, 415), (340, 415), (340, 420))
    s.ground(340, 420)
    s.wire((200, 460), (540, 460))

    # The radio.
    radio(s, 60, 560, 370, 540, right=False)

    # The board.
    s.box(540, 140, 170, 580, ["U1", "Arduino Nano", "ATmega328P", "16 MHz, 5 V"],
          [(190, "D2 INT0"), (460, "D3 INT1"), (600, "D0 RX"), (670, "D1 TX")],
          [(190, "D11 OC2A"), (290, "A0"), (390, "A1"), (530, "D4"), (560, "D5"), (590, "D6"), (620, "D7"), (650, "D8"),
           (680, "D9")], [(580, "5V"), (660, "VIN")], [(620, "GND")], title_y=228)
    s.text(625, 345, "LED: D13", "middle", 14, colour=GREY)
    s.wire((580, 140), (580, 120))
    s.supply(580, 120)
    s.wire((620, 720), (620, 735))
    s.ground(620, 735)

    # 12 V.
    s.plug(1240, "J1", [(70, 1), (120, 2)])
    s.text(1254, 158, "12 V", "middle", 14)
    s.wire((1240, 120), (1215, 120), (1215, 130))
    s.ground(1215, 130)
    s.wire((1240, 70), (1200, 70))
    s.switch_h(1140, 70, "S1", "main")
    s.wire((1140, 70), (1110, 70))
    s.fuse_h(1050, 70, "F1", "2 A slow")
    s.wire((1050, 70), (985, 70))
    s.dot(985, 70)
    s.wire((985, 70), (985, 150))
    s.wire((985, 70), (900, 70))
    s.dot(900, 70)
    s.capacitor_v(900, 70, "C3", "470 µF", polarised=True)
    s.ground(900, 110)
    s.wire((900, 70), (865, 70))
    s.diode_left(805, 70, "D1", "1N5819")
    s.wire((805, 70), (720, 70))
    s.dot(720, 70)
    s.capacitor_v(720, 70, "C4", "100 µF", polarised=True)
    s.ground(720, 110)
    s.wire((720, 70), (660, 70), (660, 140))

    # The bridge and the motor.
    s.box(900, 150, 170, 310, ["U2", "L298N module"],
          [(190, "ENA"), (290, "IN1"), (390, "IN2")], [(220, "OUT1"), (320, "OUT2")], [(985, "+12V")], [(985, "GND")],
          title_y=244)
    s.text(985, 345, "no jumper on ENA,", "middle", 14, colour=GREY)
    s.text(985, 363, "5 V regulator on", "middle", 14, colour=GREY)
    for y, name in ((190, "R4"), (290, "R5"), (390, "R6")):
        s.wire((710, y), (790, y))
        s.dot(790, y)
        s.wire((790, y), (900, y))
        s.resistor_v(790, y, name, "10 kΩ")
        s.ground(790, y + 60)
    s.wire((985, 460), (985, 468))
    s.ground(985, 468)
    s.wire((1070, 220), (1180, 220))
    s.wire((1070, 320), (1180, 320))
    s.motor(1180, 220, "M1", ["12 V"])
    s.dot(1180, 220)
    s.dot(1180, 320)
    s.wire((1180, 220), (1235, 220), (1235, 250))
    s.wire((1180, 320), (1235, 320), (1235, 290))
    s.capacitor_v(1235, 250, "", "", length=40)
    s.text(1235, 345, "C5\u2002100 nF", "middle")

    # The display.
    s.box(900, 505, 170, 300, ["U5", "HD44780", "16x2"],
          [(530, "4 RS"), (560, "6 E"), (590, "11 D4"), (620, "12 D5"), (650, "13 D6"), (680, "14 D7")],
          [(535, "2 VDD"), (585, "3 VO"), (635, "5 RW"), (665, "1 VSS"), (695, "16 K"), (765, "15 A")],
          title_y=732, title_x=970)
    for y in (530, 560, 590, 620, 650, 680):
        s.wire((710, y), (900, y))
    s.wire((1070, 535), (1160, 535))
    s.supply(1160, 525)
    s.wire((1160, 525), (1160, 535))
    s.dot(1160, 535)
    s.pot_v(1160, 535, "RV1", "10 kΩ")
    s.wire((1070, 585), (1120, 585))
    s.wire((1070, 635), (1160, 635))
    s.dot(1160, 635)
    s.wire((1070, 665), (1160, 665))
    s.dot(1160, 665)
    s.wire((1070, 695), (1160, 695))
    s.dot(1160, 695)
    s.wire((1160, 635), (1160, 665))
    s.wire((1160, 665), (1160, 695))
    s.wire((1160, 695), (1160, 708))
    s.ground(1160, 708)
    s.wire((1070, 765), (1100, 765))
    s.resistor_h(1100, 765, "R7", "220 Ω")
    s.wire((1160, 765), (1200, 765), (1200, 755))
    s.supply(1200, 755)

    for i, note in enumerate((
        "D2 high = limit hit or wire broken: motor off. D11 low: motor off.",
        "U4 is optional; it shares D0 and D1 with the USB chip: take it out to flash or to use USB.",
    )):
        s.text(40, 815 + 20 * i, note, size=14)
    s.write()


if __name__ == "__main__":
    timer()
    drive()
