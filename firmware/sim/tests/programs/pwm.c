/* OC2A in phase-correct PWM: duties one after the other, then cut by COM and PORT; then fast PWM, cut by DDR. */
#include <avr/io.h>
#include <util/delay.h>

int main(void) {
    DDRB |= _BV(3) | _BV(5);
    /* 16 MHz / 510 = 31.4 kHz */
    OCR2A = 51;
    TCCR2A = _BV(COM2A1) | _BV(WGM20);
    TCCR2B = _BV(CS20);
    _delay_us(500);
    OCR2A = 204;
    _delay_us(500);
    OCR2A = 0;
    _delay_us(200);
    OCR2A = 255;
    _delay_us(200);
    OCR2A = 102;
    _delay_us(200);
    /* The cut: the LED tells when. */
    __asm__ volatile("sbi %[pin], 5\n sts %[tccr], %[zero]\n"
                     :: [pin] "I"(_SFR_IO_ADDR(PINB)), [tccr] "n"(0xb0), [zero] "r"((uint8_t)0));
    _delay_us(200);
    /* Fast PWM, inverted, 16 MHz / 8 / 256. */
    OCR2A = 63;
    TCCR2B = 0;
    TCNT2 = 0;
    TCCR2A = _BV(COM2A1) | _BV(COM2A0) | _BV(WGM21) | _BV(WGM20);
    TCCR2B = _BV(CS21);
    _delay_us(500);
    DDRB &= ~_BV(3);
    PINB = _BV(5);
    for (;;) {}
}
