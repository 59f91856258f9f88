/* Captures both edges on ICP1 with 32 bits, as the timer's firmware does, into a table in RAM. */
#include <avr/io.h>
#include <avr/interrupt.h>

#define EDGES 128
volatile uint32_t ticks[EDGES];
volatile uint8_t levels[EDGES];
volatile uint8_t count;
static volatile uint16_t overflows;

ISR(TIMER1_OVF_vect) { overflows++; }

ISR(TIMER1_CAPT_vect) {
    uint16_t low = ICR1;
    uint16_t high = overflows;
    uint8_t rising = TCCR1B & _BV(ICES1);
    if ((TIFR1 & _BV(TOV1)) && low < 0x8000) high++;
    if (rising) TCCR1B &= ~_BV(ICES1); else TCCR1B |= _BV(ICES1);
    TIFR1 = _BV(ICF1);
    if (count < EDGES) {
        ticks[count] = (uint32_t)high << 16 | low;
        levels[count] = rising != 0;
        count++;
    }
}

int main(void) {
    DDRB |= _BV(5);
#ifdef PWM
    /* OC0B makes the edges: 16 MHz / 64 / 250 = 1 kHz, 100 of 250 ticks high. */
    DDRD |= _BV(5);
    OCR0A = 249;
    OCR0B = 99;
    TCCR0A = _BV(COM0B1) | _BV(WGM01) | _BV(WGM00);
    TCCR0B = _BV(WGM02) | _BV(CS01) | _BV(CS00);
#endif
    TCCR1A = 0;
    TCCR1B = PRESCALER; /* falling edge first */
#ifdef PWM
    TCCR1B |= _BV(ICES1);
#endif
    PORTB |= _BV(5); /* the timer runs since the instruction before, or 2 more */
    TIFR1 = _BV(ICF1) | _BV(TOV1);
    TIMSK1 = _BV(ICIE1) | _BV(TOIE1);
    sei();
    for (;;) {}
}
