/* A driver of an HD44780 on four bits, written from the data sheet; one time is too short where TOO_FAST says. */
#include <avr/io.h>
#include <util/delay.h>

/* RS D12 = PB4, E D10 = PB2, D4 to D7 = D4 to D7 = PD4 to PD7. */
static void nibble(uint8_t n) {
    PORTD = (PORTD & 0x0f) | (n << 4);
    PORTB |= _BV(2);
    _delay_us(0.5);
    PORTB &= ~_BV(2);
    _delay_us(1);
}

static void byte(uint8_t rs, uint8_t b) {
    if (rs) PORTB |= _BV(4); else PORTB &= ~_BV(4);
    nibble(b >> 4);
    nibble(b & 15);
    _delay_us(42);
}

static void print(const char *s) {
    while (*s) byte(1, *s++);
}

int main(void) {
    DDRB |= _BV(2) | _BV(4) | _BV(5);
    DDRD |= 0xf0;
    _delay_ms(15.1);
    nibble(3);
    _delay_ms(4.1);
    nibble(3);
    _delay_us(100);
    nibble(3);
    _delay_us(37);
    nibble(2);
    _delay_us(37);
    byte(0, 0x28);
    byte(0, 0x0c);
    byte(0, 0x01);
#if TOO_FAST
    _delay_us(1000); /* of 1520 */
#else
    _delay_us(1520);
#endif
    byte(0, 0x06);
    print("Slider");
    byte(0, 0x80 | 0x40);
    print("v=0.500 m/s");
    PORTB |= _BV(5);
    for (;;) {}
}
