// A person at cncjs, by the same socket as its web page: orders on standard input, one JSON
// array a line; what cncjs tells, likewise on standard output.
const io = require('socket.io-client');
const readline = require('readline');

const [, , url, token] = process.argv;
const socket = io(url, { query: 'token=' + token, transports: ['websocket'] });
const tell = (...said) => process.stdout.write(JSON.stringify(said) + '\n');

for (const event of ['connect', 'error', 'connect_error', 'serialport:open', 'serialport:error',
    'controller:state', 'sender:status', 'workflow:state', 'serialport:read']) {
    socket.on(event, (...data) => tell(event, ...data.map((each) => each instanceof Error ? String(each) : each)));
}
readline.createInterface({ input: process.stdin }).on('line', (line) => {
    const [event, ...data] = JSON.parse(line);
    socket.emit(event, ...data);
}).on('close', () => process.exit(0));
