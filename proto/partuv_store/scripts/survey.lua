-- The state of the whole store in one reading: for readiness and metrics.
local workers = {}
for _, worker in ipairs(redis.call('ZRANGEBYSCORE', key('workers'), text(now() - 30000), '+inf')) do
  workers[#workers + 1] = redis.call('GET', key('worker', worker)) or '{}'
end
return {redis.call('ZCARD', key('waiting')), redis.call('ZCARD', key('running')),
  text(stored_bytes()), redis.call('HGETALL', key('metrics')), workers,
  redis.call('ZCARD', key('webhooks'))}
