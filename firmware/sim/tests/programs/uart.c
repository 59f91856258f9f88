/* Echoes at 57600 Bd (U2X, UBRR 34) by interrupts with a buffer; polled greeting before. D13 high while it sends it. */
#include <avr/io.h>
#include <avr/interrupt.h>

static volatile uint8_t ring[64], head, tail;
volatile uint8_t overruns;

ISR(USART_RX_vect) {
    if (UCSR0A & _BV(DOR0)) overruns++;
    ring[head++ & 63] = UDR0;
    UCSR0B |= _BV(UDRIE0);
}

ISR(USART_UDRE_vect) {
    if (head == tail) UCSR0B &= ~_BV(UDRIE0);
    else UDR0 = ring[tail++ & 63];
}

static void put(uint8_t c) {
    while (!(UCSR0A & _BV(UDRE0))) {}
    UDR0 = c;
}

int main(void) {
    DDRB |= _BV(5);
    UBRR0 = 34;
    UCSR0A = _BV(U2X0);
    UCSR0B = _BV(TXEN0) | _BV(RXEN0);
    PORTB |= _BV(5);
    put('o');
    put('k');
    put('\n');
    UCSR0A |= _BV(TXC0);
    while (!(UCSR0A & _BV(TXC0))) {}
    PORTB &= ~_BV(5);
#ifndef DEAF
    UCSR0B |= _BV(RXCIE0);
    sei();
#endif
    for (;;) {}
}
