/* Interrupts of the three timers in the modes that firmware uses to keep time: CTC on 0 and 2, a moving OCR1A on 1. */
#include <avr/io.h>
#include <avr/interrupt.h>

/* Nothing but the toggle: the test counts its cycles. */
ISR(TIMER0_COMPA_vect, ISR_NAKED) { __asm__ volatile("sbi %0, 5\n reti\n" ::"I"(_SFR_IO_ADDR(PINB))); }
ISR(TIMER2_COMPA_vect) { PINB = _BV(4); }
ISR(TIMER1_COMPA_vect) { OCR1A += 5000; PINB = _BV(3); }

#ifdef FAST
/* Fast PWM with TOP in OCRA: overflow and compare come once a period. */
volatile uint8_t count_max;
ISR(TIMER0_OVF_vect) {
    PINC = _BV(0);
}
ISR(TIMER0_COMPB_vect) {
    uint8_t now = TCNT0;
    if (now > count_max) count_max = now;
    PINC = _BV(1);
}

int main(void) {
    DDRC = 3;
    OCR0A = 199;
    OCR0B = 99;
    TCCR0A = _BV(WGM01) | _BV(WGM00);
    TCCR0B = _BV(WGM02) | _BV(CS01) | _BV(CS00); /* 64 * 200 = 12800 */
    TIMSK0 = _BV(TOIE0) | _BV(OCIE0B);
    sei();
    for (;;) {}
}
#else
int main(void) {
    DDRB = _BV(5) | _BV(4) | _BV(3);
    OCR0A = 249;
    TCCR0A = _BV(WGM01);
    TCCR0B = _BV(CS01) | _BV(CS00); /* 64 * 250 = 16000 */
    OCR2A = 99;
    TCCR2A = _BV(WGM21);
    TCCR2B = _BV(CS21) | _BV(CS20); /* 32 * 100 = 3200 */
    OCR1A = 5000;
    TCCR1B = _BV(CS11); /* 8 * 5000 = 40000 */
    TIMSK0 = _BV(OCIE0A);
    TIMSK1 = _BV(OCIE1A);
    TIMSK2 = _BV(OCIE2A);
    sei();
    for (;;) {}
}
#endif
